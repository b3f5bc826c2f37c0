"""Reads a file by the readers of foreign.py and prints its content as JSON; the test compares.

    check_foreign.py xdmf|vtu|pvd|obj|ply|glb FILE
"""
import json
import sys

import numpy as np

import foreign


def ply(path):
    found = foreign.read_ply(path)
    columns = {name: found["vertices"][name] for name in found["vertices"].dtype.names}
    return {**columns, "faces": found["faces"], "comments": found["comments"]}


def glb(path):
    document = foreign.Gltf(path)
    keys = len(document.times()) if "animations" in document.json else 1
    return {"times": document.times() if keys > 1 else [], "asset": document.json["asset"],
            "nodes": document.json["nodes"],
            "shown": {mesh["name"]: [foreign.z_up(document.shown(mesh["name"], key)) for key in range(keys)]
                      for mesh in document.json["meshes"]},
            "faces": {mesh["name"]: document.faces(mesh["name"]) for mesh in document.json["meshes"]}}


READERS = {"xdmf": foreign.read_xdmf, "vtu": foreign.read_vtu, "pvd": foreign.read_pvd,
           "obj": foreign.read_obj, "ply": ply, "glb": glb}


def plain(value):
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    raise TypeError(type(value))


print(json.dumps(READERS[sys.argv[1]](sys.argv[2]), default=plain))
