"""Takes the flash images of `beltpick patterns --lcr4500` apart, bit plane by bit plane, and finds in them the patterns
that the formulas of the format give on the diamond lattice of a DLP4500. numpy only; nothing of beltpick's code.

    check_flash_images.py BIN WORK
"""

import json
import pathlib
import shutil
import struct
import subprocess
import sys

import numpy as np

WIDTH, HEIGHT, PLANES = 912, 1140, 24
LATTICE_ROWS, LATTICE_COLUMNS = np.mgrid[0:HEIGHT, 0:WIDTH]
# A diamond lattice: every second row stands half a pixel further along.
LATTICE_X = LATTICE_COLUMNS + 0.5 * (LATTICE_ROWS % 2)


def read_bmp(path):
    """Rows, columns, (blue, green, red) of a 24-bit BMP, top row first."""
    data = path.read_bytes()
    assert data[:2] == b"BM", path
    size, _, offset, header, width, height, _, bits, compression = struct.unpack("<IIIIiiHHI", data[2:34])
    assert (size, header, bits, compression) == (len(data), 40, 24, 0), path
    stride = (width * 3 + 3) // 4 * 4
    rows = np.frombuffer(data, np.uint8, stride * height, offset).reshape(height, stride)
    return rows[::-1, : width * 3].reshape(height, width, 3)


def bit_planes(path):
    """The 24 planes of an image in the controller's order: green, red, blue, the lowest bit first."""
    image = read_bmp(path)
    assert image.shape == (HEIGHT, WIDTH, 3), image.shape
    return [(image[:, :, channel] >> bit) & 1 for channel in (1, 2, 0) for bit in range(8)]


def pattern_levels(frame):
    """What a frame must show: grey levels 0..255, straight in space whatever the lattice."""
    x = LATTICE_X if frame.get("axis", "column") == "column" else LATTICE_ROWS
    if frame["kind"] == "phase":
        angle = 2 * np.pi * (x / frame["period_px"] + frame["step"] / frame["steps"]) + frame["offset_rad"]
        return 127.5 + 127.5 * np.cos(angle)
    if frame["kind"] == "gray":
        cell = np.floor((x + 0.5) / frame["cell_px"]).astype(np.int64)
        bit = ((cell ^ (cell >> 1)) >> frame["bit"]) & 1
        return 255.0 * (bit != frame["inverted"])
    return np.full((HEIGHT, WIDTH), 255.0 if frame["kind"] == "white" else 0.0)


def check(folder):
    sequence = json.loads((folder / "sequence.json").read_text())
    assert sequence["projector"] == {"width": WIDTH, "height": HEIGHT, "layout": "diamond"}
    flash = sequence["flash"]
    assert len(flash["frames"]) == len(sequence["frames"])
    images = [bit_planes(folder / name) for name in flash["images"]]
    used = [set() for _ in images]
    before = 0
    for frame, place in zip(sequence["frames"], flash["frames"]):
        levels = pattern_levels(frame)
        planes = range(place["first_plane"], place["first_plane"] + place["bits"])
        assert place["image"] in (before, before + 1), "the images are gone through one after the other"
        before = place["image"]
        assert not used[before].intersection(planes), "a plane holds one frame"
        used[before].update(planes)
        found = sum(images[before][plane].astype(int) << i for i, plane in enumerate(planes))
        if frame["kind"] == "phase":
            assert place["bits"] == 8 and place["first_plane"] % 8 == 0, place
            # The rounding of a level that lies half way between two may fall either way.
            clear = np.abs(levels % 1 - 0.5) > 1e-6
            assert np.array_equal(found[clear], np.rint(levels)[clear]), frame["file"]
            assert np.abs(found - levels).max() <= 0.5 + 1e-6, frame["file"]
        else:
            assert place["bits"] == 1, place
            assert np.array_equal(found, levels / 255), frame["file"]
    for planes, taken in zip(images, used):
        assert all(not planes[i].any() for i in range(PLANES) if i not in taken), "planes without a frame are dark"
    return sum(map(len, used)), len(images)


def check_straight(folder):
    """A stripe's phase, seen at the lattice's real places, is one plane through all rows: fringes are straight."""
    sequence = json.loads((folder / "sequence.json").read_text())
    phases = [i for i, frame in enumerate(sequence["frames"]) if frame["kind"] == "phase" and frame["axis"] == "column"]
    steps = len(phases)
    wave = np.zeros((HEIGHT, WIDTH), complex)
    for step, i in enumerate(phases):
        place = sequence["flash"]["frames"][i]
        planes = bit_planes(folder / sequence["flash"]["images"][place["image"]])
        level = sum(planes[place["first_plane"] + b].astype(float) * 2**b for b in range(8))
        wave += level * np.exp(-2j * np.pi * step / steps)
    turns = LATTICE_X / sequence["frames"][phases[0]]["period_px"]
    off = np.angle(wave * np.exp(-2j * np.pi * turns))
    assert np.abs(off).max() < 0.02, np.abs(off).max()
    # Against columns taken for straight, the odd rows would stand out by half a pixel.
    wrong = np.angle(wave * np.exp(-2j * np.pi * LATTICE_COLUMNS / sequence["frames"][phases[0]]["period_px"]))
    assert np.abs(wrong).max() > 0.1


def main():
    program, work = pathlib.Path(sys.argv[1]) / "beltpick", pathlib.Path(sys.argv[2])
    shutil.rmtree(work, ignore_errors=True)
    # sequence, axes: bit planes, images, milliseconds of loading
    expected = {
        ("fast", "column"): (47, 2, 0),
        ("standard", "column"): (72, 3, 200),
        ("robust", "column"): (115, 6, 800),
        ("fast", "both"): (94, 4, 400),
    }
    for (sequence, axes), (planes, images, load_ms) in expected.items():
        folder = work / f"{sequence}_{axes}"
        answer = json.loads(
            subprocess.run(
                [program, "patterns", "--lcr4500", "--sequence", sequence, "--axes", axes, "--json", "--out", folder],
                check=True,
                capture_output=True,
                text=True,
            ).stdout
        )
        told = answer["flash"]
        assert (told["planes"], len(told["images"]), told["load_ms"]) == (planes, images, load_ms), told
        assert check(folder) == (planes, images), folder
    check_straight(work / "fast_column")
    shutil.rmtree(work)
    print("every bit plane holds its pattern")


main()
