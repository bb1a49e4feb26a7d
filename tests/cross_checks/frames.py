"""Opens the load steps of a simulation with other programs' readers, and compares them with the OBJ files.

    python frames.py SIMULATED

SIMULATED is the folder of `ruga simulate SCENE -o SIMULATED --format obj,vtu,usda`. For every pose and layer:

- every VTU has the points and triangles of its OBJ, read by meshio, and again by VTK's own reader where the
  package `vtk` is there; every field is finite, of the length of its points or cells;
- the energies of the last VTU, times the areas of its triangles, sum up to the report's `energy_j` within 10 %;
- the PVD lists every VTU, at times that ascend;
- the USD scene (usd-core) is in metres with Y up, its time codes are the numbers of the files, and at each of
  them its mesh has the points, triangles and texture coordinates of the OBJ; its fields are those of the VTU.

A package that is not there is said so in a line, and its checks are left out. The exit code is 1 when something is
not as it should be.
"""

import json
import re
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np

# OBJ has nanometres; USD has 32 bits, of lengths up to some metres.
OBJ_LIMIT, USD_LIMIT = 1e-9, 5e-7

# The frames' mesh is not the one that energies are computed on, and its areas are not those at rest.
ENERGY_LIMIT = 0.1

faults = 0


def check(holds, text):
    global faults
    faults += not holds
    print(f"{'ok   ' if holds else 'WRONG'} {text}")


def package(name):
    try:
        return __import__(name)
    except ImportError:
        print(f"not checked: there is no package `{name}`")
        return None


meshio, vtk, pxr = package("meshio"), package("vtk"), package("pxr")


def read_obj(path):
    """Positions, triangles, texture coordinates and their triangles."""
    points, uvs, triangles, uv_triangles = [], [], [], []
    for line in path.read_text().splitlines():
        word, *rest = line.split()
        if word == "v":
            points.append([float(x) for x in rest])
        elif word == "vt":
            uvs.append([float(x) for x in rest])
        elif word == "f":
            corners = [corner.split("/") for corner in rest]
            triangles.append([int(corner[0]) - 1 for corner in corners])
            uv_triangles.append([int(corner[1]) - 1 for corner in corners])
    return [np.array(values) for values in (points, triangles, uvs, uv_triangles)]


def with_meshio(path):
    grid = meshio.read(path)
    return grid.points, grid.cells_dict["triangle"], grid.point_data, grid.cell_data_dict


def with_vtk(path):
    from vtk.util.numpy_support import vtk_to_numpy

    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()

    def arrays(data):
        found = (data.GetArray(i) for i in range(data.GetNumberOfArrays()))
        return {array.GetName(): vtk_to_numpy(array) for array in found}

    units = grid.GetPointData().GetArray("height").GetInformation().Get(vtk.vtkDataArray.UNITS_LABEL())
    if units != "m":
        check(False, f"{path.name}: VTK takes heights as {units}")
    cells = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 3)
    return vtk_to_numpy(grid.GetPoints().GetData()), cells, arrays(grid.GetPointData()), arrays(grid.GetCellData())


def check_vtu(path, obj):
    """Compares a VTU with its OBJ and returns its fields."""
    points, triangles, *_ = obj
    fields = {}
    for name, read in (("meshio", with_meshio), ("VTK", with_vtk)):
        if (meshio if name == "meshio" else vtk) is None:
            continue
        found, cells, on_points, on_cells = read(path)
        if name == "meshio":
            on_cells = {field: values["triangle"] for field, values in on_cells.items()}
        apart = np.abs(found - points).max() if found.shape == points.shape else np.inf
        same = cells.shape == triangles.shape and (cells == triangles).all()
        lengths = all(len(v) == len(points) for v in on_points.values())
        lengths &= all(len(v) == len(triangles) for v in on_cells.values())
        fields = {**on_points, **on_cells}
        finite = all(np.isfinite(values).all() for values in fields.values())
        holds = apart <= OBJ_LIMIT and same and lengths and finite and len(fields) == 11
        text = f"{path.name} by {name}: {len(points)} points {apart:.1e} m apart, {len(fields)} fields"
        if not holds or name == "VTK":
            check(holds, text)
    return fields


def check_energy(name, obj, fields, expected):
    """Compares the energies of a VTU with the joules that the report has."""
    points, triangles, *_ = obj
    a, b, c = (points[triangles[:, i]] for i in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    found = sum((fields[f"{kind}_energy"] * areas).sum() for kind in ("membrane", "bending", "foundation"))
    off = found / expected - 1
    check(abs(off) <= ENERGY_LIMIT, f"{name}: energies sum up to {found:.4g} J, {100 * off:+.1f} % off the report's")


def check_list(path, names):
    entries = ElementTree.parse(path).getroot().findall("Collection/DataSet")
    times = [float(entry.get("timestep")) for entry in entries]
    files = [entry.get("file") for entry in entries]
    check(files == names and times == sorted(set(times)), f"{path.name}: {len(files)} files at {times[0]:.3g} to {times[-1]:.3g}")


def check_usd(path, objs, fields):
    from pxr import Usd, UsdGeom

    stage = Usd.Stage.Open(str(path))
    prim = UsdGeom.Mesh(stage.GetDefaultPrim())
    in_metres = UsdGeom.GetStageMetersPerUnit(stage) == 1 and UsdGeom.GetStageUpAxis(stage) == "Y"
    codes = prim.GetPointsAttr().GetTimeSamples()
    check(in_metres and prim and codes == sorted(objs), f"{path.name}: metres, Y up, time codes {codes[0]:.0f} to {codes[-1]:.0f}")
    check((stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (codes[0], codes[-1]), f"{path.name}: starts and ends there")
    worst, same, smooth, known = 0, True, True, True
    for code in codes:
        points, triangles, uvs, uv_triangles = objs[code]
        found = np.array(prim.GetPointsAttr().Get(code))
        worst = max(worst, np.abs(found - points).max() if found.shape == points.shape else np.inf)
        same &= (np.array(prim.GetFaceVertexIndicesAttr().Get(code)) == triangles.flatten()).all()
        same &= len(prim.GetFaceVertexCountsAttr().Get(code)) == len(triangles)
        st = UsdGeom.PrimvarsAPI(prim).GetPrimvar("st")
        corners = np.array(st.ComputeFlattened(code))
        same &= np.abs(corners - uvs[uv_triangles.flatten()]).max() < 1e-6
        lengths = np.linalg.norm(np.array(prim.GetNormalsAttr().Get(code)), axis=1)
        smooth &= len(lengths) == len(points) and np.abs(lengths - 1).max() < 1e-5
        for name, values in fields.get(code, {}).items():
            if name == "normals":
                continue
            primvar = UsdGeom.PrimvarsAPI(prim).GetPrimvar(name)
            on = "vertex" if name in ("displacement", "height") else "uniform"
            known &= primvar.GetInterpolation() == on and np.array_equal(np.array(primvar.Get(code)), values)
    check(worst < USD_LIMIT and same, f"{path.name}: points {worst:.1e} m from the OBJ's, same triangles and texture coordinates")
    check(smooth, f"{path.name}: a unit normal per vertex")
    check(known, f"{path.name}: fields are those of the VTU")
    load = stage.GetDefaultPrim().GetAttribute("ruga:load").Get(codes[-1])
    check(load == 1, f"{path.name}: load {load} at the end")


def main(folder):
    lists = sorted(folder.glob("frames/*/*.pvd"))
    check(lists, f"{len(lists)} layers in {folder}")
    report = json.loads((folder / "report.json").read_text())
    energies = {(pose["name"], layer["name"]): layer["energy_j"] for pose in report["poses"] for layer in pose["layers"]}
    for path in lists:
        print(f"      {path.parent.name}, layer {path.stem}")
        pattern = re.compile(re.escape(path.stem) + r"\.(\d+)\.obj")
        numbered = ((pattern.fullmatch(file.name), file) for file in path.parent.iterdir())
        objs = {float(match[1]): read_obj(file) for match, file in numbered if match}
        fields, names = {}, []
        for number in sorted(objs):
            name = f"{path.stem}.{int(number):04}.vtu"
            names.append(name)
            fields[number] = check_vtu(path.parent / name, objs[number])
        if fields[number]:
            check_energy(names[-1], objs[number], fields[number], energies[path.parent.name, path.stem])
        check_list(path, names)
        if pxr:
            check_usd(path.with_suffix(".usda"), objs, fields)
    return 1 if faults else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(Path(sys.argv[1])))
