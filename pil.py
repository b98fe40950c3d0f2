from PIL import Image
import glob
for p in sorted(glob.glob('*.gif')+glob.glob('*.webp')+glob.glob('*.GIF')):
    try:
        i=Image.open(p); d=[]
        for k in range(getattr(i,'n_frames',1)):
            i.seek(k); i.load(); d.append(i.info.get('duration'))
        print(p,i.format,i.size,i.mode,'n',getattr(i,'n_frames',1),'dur',d,'loop',i.info.get('loop'))
    except Exception as e: print(p,repr(e))
