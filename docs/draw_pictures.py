"""Draws the pictures and movies of docs/scenes, docs/movies and the README anew.

    python3 docs/draw_pictures.py                    all of them, about five minutes on two cores
    python3 docs/draw_pictures.py touch-head gears   those of some scenes
    python3 docs/draw_pictures.py --program build/strict/bin/palpate

Needs a built palpate and Pillow (Debian package python3-pil), which scales pictures to the width of a page.
"""
import argparse
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parent.parent
MOVIE_S = 2.0          # length of a movie on docs/movies.md
MOVIE = ("--size", "360x326", "--fps", "7")
CONTACT = (1100, 550)  # size of a picture of contact on docs/scenes.md

# Scene: its picture on docs/scenes.md, and the seconds that it simulates if it has a movie on docs/movies.md.
# A picture is "contact" or "picture" (at the largest force), or the size and the time [s] of a frame. Those
# of contact show the proxies of the paper's method, in image space.
SCENES = {
    "touch-head": ("contact", 0.4),
    "press-head": (("720x654", 0.15), None),
    "touch-human": ("contact", 0.4),
    "two-heads": ("contact", 0.3),
    "two-pumpkins": ("contact", 0.3),
    "gears": ("contact", 0.3),
    "scrape-pumpkin": ("contact", 0.5),
    "posable-human": ("contact", 3.0),
    "pumpkin-in-hand": ("contact", 1.5),
    "head-in-hand": ("contact", 1.2),
    "gear-in-hand": ("contact", 0.8),
    "squeeze-ball": ("picture", 0.6),
    "press-stack": ("picture", 0.4),
    "lift-ball": (("480x434", 0.81), 1.7),
    "two-hands": (("480x434", 0.9), 1.2),
    "press-ball": ("picture", None),
}


def call(*words):
    """Runs a command; its output is shown only if it fails."""
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))}\n{done.stdout}{done.stderr}")


def save(source, target, size=None):
    """Writes a picture without an alpha channel, scaled if a size is given."""
    image = Image.open(source).convert("RGB")
    if size:
        image = image.resize(size, Image.LANCZOS)
    image.save(target, optimize=True)
    print(f"{target.relative_to(ROOT)}: {image.width} x {image.height}, {target.stat().st_size // 1000} kB")


def in_images(scene):
    """Returns the options that find all contact between bodies and tools in image space."""
    tables = tomllib.loads(scene.read_text())
    obstacles = {obstacle["name"] for obstacle in tables.get("obstacle", [])}
    out = []
    for i, contact in enumerate(tables["contact"]):
        if not obstacles & set(contact["between"]):
            out += ["--set", f"contact.{i}.method=image"]
    return out


def draw(program, name, folder):
    """Runs one scene, and draws its picture and its movie."""
    picture, duration = SCENES[name]
    scene = ROOT / "scenes" / f"{name}.toml"
    run = (program, "run", scene, "-o", folder)
    target = ROOT / "docs" / "scenes" / f"{name}.png"
    if picture == "contact":
        call(*run, "--contact-picture", *in_images(scene))
        save(folder / "contact.png", target, CONTACT)
        call(*run)
    elif picture == "picture":
        call(*run, "--picture")
        save(folder / "picture.png", target if duration else ROOT / "scenes" / f"{name}.png")
    else:
        size, time = picture
        rate = 20
        call(*run, "--frames", "--frames-per-s", rate, "--size", size)
        frames = sorted((folder / "frames").glob("*.png"))
        save(frames[min(round(time * rate), len(frames) - 1)], target)
    if duration:
        movie = ROOT / "docs" / "movies" / f"{name}.png"
        call(program, "movie", folder, "-o", movie, *MOVIE, "--slow", f"{MOVIE_S / duration:.4g}")
        print(f"{movie.relative_to(ROOT)}: {movie.stat().st_size // 1000} kB")
    if name == "press-ball":  # the movie of docs/running.md
        call(program, "movie", folder, "-o", target, "--size", "300x272", "--fps", "5", "--slow", "5")
        print(f"{target.relative_to(ROOT)}: {target.stat().st_size // 1000} kB")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"default: all of {', '.join(SCENES)}")
    parser.add_argument("--program", default=ROOT / "build" / "release" / "bin" / "palpate", type=Path,
                        help="the built program; default: %(default)s")
    given = parser.parse_args()
    unknown = [name for name in given.scenes if name not in SCENES]
    if unknown:
        parser.error(f"no picture of \"{unknown[0]}\"; scenes: {', '.join(SCENES)}")
    if not given.program.exists():
        parser.error(f"{given.program}: no such program; build it with ./palpate build palpate")
    for name in given.scenes or SCENES:
        with tempfile.TemporaryDirectory() as folder:
            draw(given.program.resolve(), name, Path(folder) / name)


if __name__ == "__main__":
    main()
