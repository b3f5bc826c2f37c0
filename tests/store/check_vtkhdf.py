"""Reads a run as VTK's own reader does, and prints what VTK would show; the test compares.

VTK's arithmetic for an UnstructuredGrid with Steps, per step s and with one part:
  points        Points[PointOffsets[s] :][: NumberOfPoints[PartOffsets[s]]]
  cell offsets  Offsets[CellOffsets[s] + PartOffsets[s] :][: NumberOfCells + 1]
  connectivity  Connectivity[ConnectivityIdOffsets[s] :][: NumberOfConnectivityIds]
  types         Types[CellOffsets[s] :][: NumberOfCells]
  data          PointData/X[PointDataOffsets/X[s] :], CellData/X[CellDataOffsets/X[s] :]
"""
import json
import sys

import h5py
import numpy as np


def demand(condition, what):
    if not condition:
        sys.exit("check_vtkhdf: " + what)


with h5py.File(sys.argv[1], "r") as file:
    root = file["VTKHDF"]
    demand(list(root.attrs["Version"]) == [2, 0], "Version")
    kind = root.attrs.get_id("Type")
    demand(kind.dtype.kind == "S" and not h5py.check_string_dtype(kind.dtype).length is None,
           "Type must be a string of fixed length")
    demand(root.attrs["Type"] == b"UnstructuredGrid", "Type")
    steps = root["Steps"]
    count = int(steps.attrs["NSteps"])
    for name in ("Connectivity", "Offsets", "NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"):
        demand(root[name].dtype == np.int64 and root[name].ndim == 1, name)
    demand(root["Types"].dtype == np.uint8, "Types")
    demand(root["Points"].ndim == 2 and root["Points"].shape[1] == 3, "Points")
    shown = []
    for s in range(count):
        demand(steps["NumberOfParts"][s] == 1, "NumberOfParts")
        part, first = int(steps["PartOffsets"][s]), int(steps["CellOffsets"][s])
        sizes = ("NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds")
        n, cells, ids = (int(root[name][part]) for name in sizes)
        offsets = root["Offsets"][first + part:][:cells + 1]
        start = int(steps["ConnectivityIdOffsets"][s])
        step = {
            "time": float(steps["Values"][s]),
            "points": root["Points"][int(steps["PointOffsets"][s]):][:n].tolist(),
            "offsets": offsets.tolist(),
            "connectivity": root["Connectivity"][start:start + ids].tolist(),
            "types": root["Types"][first:first + cells].tolist(),
        }
        for kind, size in (("Point", n), ("Cell", cells)):
            for name, data in root[kind + "Data"].items():
                values = data[int(steps[kind + "DataOffsets"][name][s]):][:size]
                demand(len(values) == size, f"{kind}Data/{name} is too short")
                step[name] = values.tolist()
        demand(len(offsets) == cells + 1 and offsets[-1] == ids, "Offsets")
        demand(len(step["points"]) == n, "Points are too few")
        shown.append(step)
    units = {name: root["PointData"][name].attrs["units"].decode() for name in root["PointData"]}
    scene = file["palpate/scene"][()].decode()
print(json.dumps({"steps": shown, "units": units, "scene": scene}))
