#!/usr/bin/env bash
# Assimp 5.2.5 (Debian 12: libassimp-dev 5.2.5~ds0-1+b1): the unit of a 3MF file.
#
# A 3MF model names its unit, e.g. <model unit="meter">, and millimeter where it names none.
# Expected: models of one size in different units come out at one scale, at least with aiProcess_GlobalScale, or the
#   unit is in the scene's metadata.  The same library does so with COLLADA's <unit>: a scale in the root node.
# Seen: coordinates are as in the file, the root's transformation is the identity, the metadata has no unit.  A part
#   in millimetres and one in metres cannot be told apart: a factor of 1000 in size, of 1e9 in mass.
package=libassimp-dev version=5.2.5~ds0-1+b1
set -euo pipefail
skip() { echo "cannot run here: $*"; exit 77; }
command -v g++ >/dev/null || skip "g++ is missing"
[[ -x /usr/bin/python3 ]] || skip "/usr/bin/python3 is missing"
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
cd "$folder"
usr=$folder/usr lib=$folder/usr/lib/$(uname -m)-linux-gnu
if [[ $(dpkg-query -W -f='${Version}' "$package" 2>/dev/null) != "$version" ]]; then
  apt-get -s --no-install-recommends install "$package=$version" >plan 2>/dev/null ||
    skip "apt has no $package $version"
  sed -nE 's/^Inst ([^ ]+) .*\(([^ ]+) .*/\1=\2/p' plan | xargs apt-get download >/dev/null 2>&1 || skip "no network"
  for archive in *.deb; do dpkg -x "$archive" .; done
fi
/usr/bin/python3 - <<'END'
import zipfile
points = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
faces = ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))
vertices = "".join('<vertex x="%g" y="%g" z="%g"/>' % p for p in points)
triangles = "".join('<triangle v1="%d" v2="%d" v3="%d"/>' % f for f in faces)
package = "http://schemas.openxmlformats.org/package/2006/"
for unit in ("meter", "millimeter"):
    with zipfile.ZipFile(unit + ".3mf", "w") as file:
        file.writestr("[Content_Types].xml", f'<Types xmlns="{package}content-types"><Default Extension="rels" '
                      f'ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default '
                      'Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>'
                      "</Types>")
        file.writestr("_rels/.rels", f'<Relationships xmlns="{package}relationships"><Relationship Id="m" Target='
                      '"/3D/3dmodel.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>'
                      "</Relationships>")
        file.writestr("3D/3dmodel.model", f'<model unit="{unit}" xmlns="http://schemas.microsoft.com/3dmanufacturing/'
                      'core/2015/02"><resources><object id="1" type="model"><mesh><vertices>' + vertices +
                      "</vertices><triangles>" + triangles + '</triangles></mesh></object></resources><build>'
                      '<item objectid="1"/></build></model>')
    with open(unit + ".dae", "w") as file:
        file.write('<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit '
                   f'name="{unit}" meter="{1 if unit == "meter" else 0.001}"/></asset><library_geometries><geometry '
                   'id="g"><mesh><source id="p"><float_array id="a" count="9">0 0 0 1 0 0 0 1 0</float_array>'
                   '<technique_common><accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param '
                   'name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>'
                   '<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="1"><input '
                   'semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry>'
                   '</library_geometries><library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry '
                   'url="#g"/></node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/>'
                   "</scene></COLLADA>")
END
cat >unit.cpp <<'END'
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

// The greatest x of the mesh in the frame of the scene; words of the metadata that speak of a unit are printed.
double size(const std::string& path, unsigned flags) {
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(path, flags | aiProcess_PreTransformVertices);
  if (!scene) return 0;
  double greatest = 0;
  for (unsigned i = 0; i < scene->mMeshes[0]->mNumVertices; ++i)
    greatest = std::max(greatest, double(scene->mMeshes[0]->mVertices[i].x));
  for (unsigned i = 0; scene->mMetaData && i < scene->mMetaData->mNumProperties; ++i) {
    const std::string key = scene->mMetaData->mKeys[i].C_Str();
    if (key.find("nit") != std::string::npos) std::printf("%s: metadata %s\n", path.c_str(), key.c_str());
  }
  return greatest;
}

int main() {
  bool ignored = true;
  for (const unsigned flags : {0u, unsigned(aiProcess_GlobalScale)}) {
    const double metre = size("meter.3mf", flags), millimetre = size("millimeter.3mf", flags);
    std::printf("an edge of 1, %s: %g in metres, %g in millimetres\n", flags ? "GlobalScale" : "no flags", metre,
                millimetre);
    ignored = ignored && metre == 1 && millimetre == 1;
  }
  const double metre = size("meter.dae", 0), millimetre = size("millimeter.dae", 0);
  std::printf("from COLLADA: %g in metres, %g in millimetres\n", metre, millimetre);
  return ignored && metre == 1 && std::abs(millimetre - 0.001) < 1e-9 ? 0 : 1;
}
END
g++ -std=c++17 -isystem "$usr/include" unit.cpp -o unit -L"$lib" -Wl,-rpath-link,"$lib" -lassimp ||
  skip "it does not compile"
LD_LIBRARY_PATH=$lib ./unit || { echo "this has changed"; exit 1; }
