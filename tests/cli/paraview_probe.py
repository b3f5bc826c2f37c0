"""Opens files in ParaView, by ParaView's own Python, and prints their content as JSON.

    pvpython paraview_probe.py READER:FILE...

READER is a name of paraview.simple, or "any": ParaView's default reader.
"""
import json
import sys

from paraview import servermanager, simple


def leaves(data):
    """Returns the grids of a data set, including nested ones."""
    if not data.IsA("vtkCompositeDataSet"):
        return [data]
    iterator = data.NewIterator()
    iterator.InitTraversal()
    out = []
    while not iterator.IsDoneWithTraversal():
        out.append(iterator.GetCurrentDataObject())
        iterator.GoToNextItem()
    return out


def arrays(attributes):
    """Returns name, number of components, and range of the first component."""
    found = [attributes.GetArray(i) for i in range(attributes.GetNumberOfArrays())]
    return {one.GetName(): [one.GetNumberOfComponents(), *one.GetRange(0)] for one in found}


def shown(source, time):
    source.UpdatePipeline(time)
    return [{"points": grid.GetNumberOfPoints(), "cells": grid.GetNumberOfCells(), "bounds": grid.GetBounds(),
             "point_data": arrays(grid.GetPointData()), "cell_data": arrays(grid.GetCellData())}
            for grid in leaves(servermanager.Fetch(source))]


def probe(reader, path):
    if reader == "any":
        source = simple.OpenDataFile(path)
    else:
        key = "FileNames" if reader in ("XDMFReader", "PLYReader") else "FileName"
        source = getattr(simple, reader)(**{key: [path]})
    source.UpdatePipelineInformation()
    times = list(getattr(source, "TimestepValues", None) or [])
    # to the end, back, and into the middle: a reader may cache data
    visited = sorted({0, len(times) // 2, len(times) - 1}) if times else []
    steps = {i: shown(source, times[i]) for i in [*visited, *reversed(visited)]}
    return {"reader": reader, "path": path, "times": times, "steps": steps or {0: shown(source, 0.0)}}


results = [probe(*argument.split(":", 1)) for argument in sys.argv[1:]]
version = simple.GetParaViewVersion()
print("SHOWN " + json.dumps({"version": [version.major, version.minor], "files": results}))
