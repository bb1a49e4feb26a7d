"""Makes the zip that Blender installs.

    python package.py ruga-blender.zip

`blender --command extension build` in the folder `ruga` does the same with Blender at hand.
"""

import sys
import zipfile
from pathlib import Path

SOURCE = Path(__file__).resolve().parent / "ruga"


def package(target: Path) -> list[str]:
    """Writes the zip; the names in it."""
    files = sorted(path for path in SOURCE.iterdir() if path.suffix in (".py", ".toml"))
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in files:
            archive.write(path, path.name)
    return [path.name for path in files]


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    print(f"{sys.argv[1]}: {len(package(Path(sys.argv[1])))} files")
