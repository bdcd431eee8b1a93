"""Tests every reader with damaged files: `python tests/benchmarks/fuzz_readers.py --count 10000` counts inputs that are read or refused.

Each input is made from its number alone, so that any input can be made again (`--first N --count 1 --reader scene`). A separate process
reads the inputs, with limits on time and memory. Where it dies, the input is counted, and a new process reads the next inputs.
"""

import on_path  # noqa: F401, I001  first, because it makes the next imports possible
import argparse
import json
import os
import random
import resource
import signal
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

import mesh_files as meshes
import numpy as np
import wall_drawings
from fuzz_mutations import forged, mutated_bytes, mutated_text

from comparison.yade.installation import find_yade
from comparison.yade.process import run_yade
from comparison.yade.run_record import read_run
from la_core.analysis import case_file, stage
from la_core.analysis.modelling import structural_model
from la_core.errors import SceneError
from la_core.exchange.checksummed_file import ExchangeError, write_sealed
from la_core.repair import close_joints
from la_core.scene.from_file import scene_from_file
from la_core.scene.generators.drawings import drawing_blocks
from la_core.scene.generators.mesh import MeshFile, mesh_blocks
from la_core.scene.scene import load_scene, scene_of_text
from la_core.scene.schema.drawing import Drawing
from la_core.scene.schema.mesh import Mesh
from la_core.scene.shipped import find

SECONDS = 5.0  # processor seconds for one input
PATIENCE = 120.0  # s of wall time for one input
MEMORY = 3 * 2**30  # bytes of address space for the process that reads
SMALL = 40  # blocks; scenes with no more blocks are modelled, too
SCENES = (
    "two_pads", "trilith", "two_blocks", "arch_spreading", "arch_diagonal", "flat_arch", "slab_four_corners", "dome_sector",
    "wall_third", "facade", "vault_spreading", "corner_settling_end", "ferris_tin_loi_1", "rubble_wall", "building_corner",
)  # fmt: skip
READ, REFUSED = "read", "refused"
INTRODUCTION = (
    "# Damaged files",
    "",
    "Valid scenes, meshes and results are damaged at random and read again. A reader may read such a file or refuse it with a message;",
    "a crash, a traceback or an endless loop counts as *anything else*, and none may occur.",
    "",
)


@dataclass(frozen=True)
class Reader:
    """A reader and its damaged inputs. `attempt` reads one input and raises SceneError or ExchangeError where it is refused."""

    name: str
    what: str
    attempt: Callable[[random.Random], None]


def readers(folder: Path) -> list[Reader]:
    """Return all readers. Their files are written in `folder`."""
    return [
        Reader("scene", "shipped scenes (TOML), small ones up to their model", _scene_attempt()),
        *(Reader(name, f"{what} of a wall's blocks", _mesh_attempt(suffix, content)) for name, what, suffix, content in _mesh_files()),
        *(Reader(name, f"{name.upper()} of a wall, with closed joints", _drawing_attempt(name, content)) for name, content in _drawings()),
        Reader("new", "DXF, SVG and OBJ by `crosscheck new --from`, and the scene that it writes", _new_attempt(folder)),
        *_exchange_readers(folder),
    ]


def _scene_attempt() -> Callable[[random.Random], None]:
    texts = {name: find(name).read_bytes() for name in SCENES}

    def attempt(chance: random.Random) -> None:
        name = chance.choice(SCENES)
        content = mutated_text(texts[name], texts[chance.choice(SCENES)], chance)
        try:
            text = content.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            raise SceneError(name, "not UTF-8 text") from error  # as the reader of scene files does
        scene = scene_of_text(text, find(name), name)
        if len(scene.blocks) <= SMALL:
            structural_model(scene)

    return attempt


def _mesh_files() -> Iterator[tuple[str, str, str, bytes]]:
    bodies = {name: vertices for name, (vertices, _) in list(meshes.wall().items())[:4]}
    one = next(iter(bodies.values()))
    ascii_stl = ["solid x"]
    for triangle in meshes.TRIANGLES:
        ascii_stl += ["facet normal 0 0 0", "outer loop", *(f"vertex {x!r} {y!r} {z!r}" for x, y, z in one[list(triangle)].tolist())]
        ascii_stl += ["endloop", "endfacet"]
    yield "obj", "OBJ", ".obj", meshes.obj(bodies).encode()
    yield "ply", "PLY as text", ".ply", meshes.ply(one).encode()
    yield "stl text", "STL as text", ".stl", "\n".join([*ascii_stl, "endsolid x\n"]).encode()
    yield "stl", "binary STL", ".stl", meshes.stl(one)
    yield "compas", "COMPAS assembly (JSON)", ".json", meshes.compas(meshes.wall()).encode()
    yield "old compas", "COMPAS assembly of version 0.1 (JSON)", ".json", meshes.compas_of_old(meshes.wall()).encode()


def _mesh_attempt(suffix: str, content: bytes) -> Callable[[random.Random], None]:
    table = Mesh(file=f"wall{suffix}")

    def attempt(chance: random.Random) -> None:
        is_text = b"\0" not in content
        damaged = mutated_text(content, content, chance) if is_text and chance.random() < 0.7 else mutated_bytes(content, chance)
        mesh_blocks(table, [MeshFile(PurePosixPath(table.file), damaged, of_folder=False)], 0.0)

    return attempt


def _drawings() -> Iterator[tuple[str, bytes]]:
    yield "dxf", wall_drawings.wall_dxf()
    yield "svg", wall_drawings.wall_svg()


def _drawing_attempt(suffix: str, content: bytes) -> Callable[[random.Random], None]:
    table = Drawing(file=f"wall.{suffix}", thickness=0.3, joints=0.012)

    def attempt(chance: random.Random) -> None:
        damaged = mutated_text(content, content, chance) if chance.random() < 0.7 else mutated_bytes(content, chance)
        blocks, _ = drawing_blocks(table, MeshFile(PurePosixPath(table.file), damaged, of_folder=False), 0.002)
        close_joints([one.name for one in blocks], [one.shape for one in blocks], 0.002, np.full(len(blocks), table.joints))

    return attempt


def _new_attempt(folder: Path) -> Callable[[random.Random], None]:
    bodies = {name: vertices for name, (vertices, _) in list(meshes.wall().items())[:4]}
    whole = {**dict(_drawings()), "obj": meshes.obj(bodies).encode()}

    def attempt(chance: random.Random) -> None:
        suffix = chance.choice(sorted(whole))
        content, source = whole[suffix], folder / f"wall.{suffix}"
        source.write_bytes(mutated_text(content, content, chance) if chance.random() < 0.7 else mutated_bytes(content, chance))
        scene_of_text(scene_from_file(source, folder), folder / "wall.toml", "wall")

    return attempt


def _exchange_readers(folder: Path) -> Iterator[Reader]:
    scene = load_scene(find("two_pads"))
    analysis = stage.analyse(scene)
    case_file.write_case(folder / "case.h5", analysis, "")
    run_yade(find_yade(), folder, "", PATIENCE, lambda report: None)
    whole = {name: (folder / name).read_bytes() for name in ("case.h5", "run.h5")}
    path = folder / "damaged.h5"
    read = {"case.h5": lambda: case_file.read_case(path, scene), "run.h5": lambda: read_run(path, analysis.assembly)}

    def damaged(name: str) -> Callable[[random.Random], None]:
        def attempt(chance: random.Random) -> None:
            content = mutated_bytes(whole[name], chance)
            path.write_bytes(content)
            read[name]()
            assert content == whole[name], "read although it is damaged"

        return attempt

    def sealed_again(name: str) -> Callable[[random.Random], None]:
        def attempt(chance: random.Random) -> None:
            write_sealed(path, forged(whole[name], chance))
            read[name]()

        return attempt

    for name in whole:
        yield Reader(name, f"{name}, damaged", damaged(name))
        yield Reader(f"{name} forged", f"{name}, changed and sealed again", sealed_again(name))


def outcome(reader: Reader, number: int) -> str:
    """Return a reader's outcome for the input of this number."""
    try:
        reader.attempt(random.Random(f"{reader.name} {number}"))
    except (SceneError, ExchangeError) as error:
        return REFUSED if str(error).strip() else "refused without a word"
    except Exception as error:
        return f"{type(error).__name__}: {str(error)[:100]}"
    return READ


def outcomes(reader: Reader, numbers: range) -> Iterator[tuple[int, str]]:
    """Yield number and outcome of every input, from separate processes. A process that dies is counted and replaced."""
    while numbers:
        listen, tell = os.pipe()
        child = os.fork()
        if child == 0:
            os.close(listen)
            _tell_all(reader, numbers, tell)
        os.close(tell)
        done = 0
        with os.fdopen(listen) as lines:
            for line in lines:
                yield numbers[done], json.loads(line)
                done += 1
        _, status = os.waitpid(child, 0)
        if done < len(numbers):
            number = signal.Signals(os.WTERMSIG(status)).name if os.WIFSIGNALED(status) else f"exit code {status}"
            yield numbers[done], "took too long" if number in ("SIGPROF", "SIGALRM") else f"died: {number}"
            done += 1
        numbers = numbers[done:]


def _tell_all(reader: Reader, numbers: range, tell: int) -> None:
    """Read the inputs in the child process, and write one line for each. The system ends the process where an input takes too long."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # drops the messages of libraries
    for number in numbers:
        signal.setitimer(signal.ITIMER_PROF, SECONDS)  # the signals of both timers end the process
        signal.setitimer(signal.ITIMER_REAL, PATIENCE)
        found = outcome(reader, number)
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        os.write(tell, json.dumps(found).encode() + b"\n")
    os._exit(0)


def table(counts: dict[str, Counter[str]], whats: dict[str, str], count: int) -> str:
    """Return the counts as Markdown."""
    rows = [*INTRODUCTION, f"`python tests/benchmarks/fuzz_readers.py --count {count} --write comparison/gallery/fuzz.md`", ""]
    rows += [f"{count} inputs for each reader.", ""]
    rows += ["| input | read | refused in words | anything else |", "|---|---|---|---|"]
    for name, counter in counts.items():
        others = count - counter[READ] - counter[REFUSED]
        rows.append(f"| {whats[name]} | {counter[READ]} | {counter[REFUSED]} | {others} |")
    return "\n".join(rows) + "\n"


def main() -> int:
    """Run the command. Return 1 where a reader did anything but read or refuse."""
    parser = argparse.ArgumentParser(description="Damaged files, and what the readers do with them.")
    parser.add_argument("--count", type=int, default=200, help="inputs for each reader")
    parser.add_argument("--first", type=int, default=0, help="number of the first input")
    parser.add_argument("--reader", action="append", help="one reader alone, by name")
    parser.add_argument("--write", type=Path, help="Markdown file for the counts")
    options = parser.parse_args()
    counts: dict[str, Counter[str]] = {}
    with tempfile.TemporaryDirectory() as folder:
        all_readers = [one for one in readers(Path(folder)) if not options.reader or one.name in options.reader]
        for reader in all_readers:
            counts[reader.name] = Counter()
            for number, found in outcomes(reader, range(options.first, options.first + options.count)):
                counts[reader.name][found] += 1
                if found not in (READ, REFUSED):
                    print(f"{reader.name} {number}: {found}", file=sys.stderr, flush=True)
            print(f"{reader.name}: {dict(counts[reader.name])}", file=sys.stderr, flush=True)
    text = table(counts, {one.name: one.what for one in all_readers}, options.count)
    print(text, end="")
    if options.write:
        options.write.write_text(text, encoding="utf-8")
    return int(any(set(counter) - {READ, REFUSED} for counter in counts.values()))


if __name__ == "__main__":
    sys.exit(main())
