"""Mean radiances of real scenes by Mitsuba 3: what the importer's tests hold ours against.

    python means.py PATH_OF_SCENES means.json      (needs: pip install mitsuba)

Each scene is rendered at a small size with the integrator `path` of its own depth, in several independent parts, whose
scatter gives the standard error. Values above 10 count as 10 in `clamped`, pixel by pixel after all parts are averaged.
"""
import json
import sys
from pathlib import Path

import mitsuba
import numpy

SCENES = {
    "cornell-box/scene.xml": 1024,
    "veach-mis/scene.xml": 65536,
    "veach-bidir/scene.xml": 4096,
    "staircase/scene.xml": 1024,
    "living-room/scene.xml": 2048,
    "classroom/scene.xml": 2048,
    "teapot-env/scene.xml": 512,
    "manylights-pbrt/scene.xml": 1024,
}
WIDTH = 96
PARTS = 8


def main(folder, out):
    mitsuba.set_variant("llvm_ad_rgb")
    results = json.loads(Path(out).read_text()) if Path(out).exists() else {}
    for name, samples in SCENES.items():
        if name in results:
            continue
        scene = mitsuba.load_file(str(Path(folder) / name))
        film = scene.sensors()[0].film()
        width, height = (int(n) for n in film.size())
        size = [WIDTH, round(WIDTH * height / width)]
        parameters = mitsuba.traverse(scene)
        for key in [k for k in parameters.keys() if k.endswith("film.size")]:
            parameters[key] = size
        for key in [k for k in parameters.keys() if k.endswith("film.crop_size")]:
            parameters[key] = size
        parameters.update()
        parts = []
        for part in range(PARTS):
            image = numpy.array(mitsuba.render(scene, spp=samples // PARTS, seed=part))[..., :3]
            parts.append(image)
        means = [p.mean(axis=(0, 1)) for p in parts]
        grey = [float(m.mean()) for m in means]
        results[name] = {
            "size": size,
            "samples": samples,
            "mean": [float(v) for v in numpy.mean(means, axis=0)],
            "relative_error": float(numpy.std(grey, ddof=1) / len(grey) ** 0.5 / numpy.mean(grey)),
            "clamped": float(numpy.minimum(numpy.mean(parts, axis=0), 10).mean()),
            "mitsuba": mitsuba.__version__,
        }
        print(name, results[name], flush=True)
        Path(out).write_text(json.dumps(results, indent=1) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
