export GALLIVM_PERF=nopt LP_NATIVE_VECTOR_WIDTH=128 MESA_SHADER_CACHE_DIR=/tmp/review3/cache MESA_SHADER_CACHE_MAX_SIZE=1G
export PATH=/tmp/review3/bin:$PATH; R=/tmp/reflet-now
cat > s.toml <<'E'
version = 1
camera.main = { eye = [0, 1, 4], target = [0, 0.5, 0] }
environment = { color = [0.4, 0.5, 0.7] }
material.m = { base_color = "3000 K" }
model.b = { shape = { kind = "box" }, material = "m" }
timeline = { end = 4, fps = 24 }
[[instance]]
model = "b"
name = "b"
[motion.instance.b]
translation = { rate = [0.5, 0, 0] }
E
$R check s.toml 2>&1 | tail -3
r(){ echo "--- $*"; timeout 20 $R render s.toml --samples 1 "$@" 2>&1 | grep -v '^frame' | cut -c1-300 | tail -4; }
r -o a.gif --size 33x19; r -o a.webp --size 33x19; r -o one.gif --size 1x1 --frames 0; r -o one.webp --size 1x1 --frames 0; r -o two.gif --size 7x5 --frames 0-1 --set timeline.fps=50; r -o f51.gif --size 8x8 --set timeline.fps=51;r -o slow.gif --size 8x8 --set timeline.fps=0.002 --frames 0-1;r -o slow2.gif --size 8x8 --set timeline.fps=0.0019; r -o w90.webp --size 8x8 --set timeline.fps=90; r -o w91.webp --size 8x8 --set timeline.fps=91; r -o slow.webp --size 8x8 --set timeline.fps=0.001 --frames 0-1; r -o f30.gif --size 8x8 --set timeline.fps=30; r -o f.GIF --size 8x8; r -o f.mp4 --size 33x19;  r -o b.webp --size 16384x1 --frames 0-1; r -o "f.####.gif" --size 8x8; r -o x.gif --aov depth --size 8x8; r -o a.gif --resume --size 8x8; r -o al.gif --set image.alpha=true --size 8x8; r -o sub/none.gif --size 8x8
