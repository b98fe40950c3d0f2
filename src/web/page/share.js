// Texts of a scene in the fragment of an address, which browsers send nowhere: JSON, deflated, in base64url.
const MOST_CHARACTERS = 256 * 1024;
const MOST_BYTES = 1024 * 1024;

// Scenes, by their names; the file of a project is text, and no scene.
export const is_scene = (name) => /\.toml$/i.test(name) && !/(^|\/)reflet\.toml$/i.test(name);

const through = (bytes, stream) => new Response(new Blob([bytes]).stream().pipeThrough(stream));

export const toFragment = async (texts) => {
  const bytes = new TextEncoder().encode(JSON.stringify(texts));
  const packed = new Uint8Array(await through(bytes, new CompressionStream("deflate-raw")).arrayBuffer());
  const binary = Array.from(packed, (byte) => String.fromCharCode(byte)).join("");
  return btoa(binary).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
};

export const fromFragment = async (fragment) => {
  if (fragment.length > MOST_CHARACTERS) throw new Error(`it is longer than ${MOST_CHARACTERS} characters`);
  if (!/^[\w-]+$/.test(fragment)) throw new Error("it has characters that `share` never writes");
  let text = "";
  try {
    const packed = Uint8Array.from(atob(fragment.replaceAll("-", "+").replaceAll("_", "/")), (letter) => letter.charCodeAt(0));
    const reader = through(packed, new DecompressionStream("deflate-raw")).body.getReader();
    const decoder = new TextDecoder("utf-8", { fatal: true });
    for (let read = 0, part; !(part = await reader.read()).done;) {
      read += part.value.length;
      if (read > MOST_BYTES) throw new RangeError(`its texts are longer than ${MOST_BYTES} bytes`);
      text += decoder.decode(part.value, { stream: true });
    }
    text += decoder.decode();
  } catch (error) {
    throw error instanceof RangeError ? error : new Error("it is cut off or changed");
  }
  let texts = null;
  try {
    texts = JSON.parse(text);
  } catch {
    // Answered below, as other values are.
  }
  const entries = texts && typeof texts === "object" ? Object.entries(texts) : [];
  const isPath = (name) => /^[^\\\0]{1,200}$/.test(name) && name.split("/").every((part) => part && part !== "..");
  const isText = ([name, content]) => isPath(name) && typeof content === "string";
  if (!entries.length || !entries.every(isText) || !is_scene(entries[0][0])) throw new Error("it holds no texts of a scene");
  return texts;
};
