#include <array>

#include "helpers.h"
#include "palpate/mesh/boundary.h"

using namespace palpate;
using namespace palpate::mesh;

namespace {

// Two tetrahedra on the faces of the triangle (1,0,0), (0,1,0), (0,0,1): the unit corner, 1/6, and its
// mirrored point (1,1,1), 1/3.
constexpr const char* kGmsh22 = R"($Comments
 any text, $Nodes too
$EndComments
$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
1
3 1 "tissue"
$EndPhysicalNames
$Nodes
5
10 0 0 0
7 1 0 0
300 0 1 0
2000000000 0 0 1
5 1. 1.0e0 +1
$EndNodes
$Elements
4
1 15 2 0 1 10
2 2 2 0 1 10 7 300
3 4 2 0 1 10 7 300 2000000000
9 4 0 7 300 2000000000 5
$EndElements
)";

constexpr const char* kGmsh41 = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$Entities
0 0 0 1
1 0 0 0 1 1 1 0 0
$EndEntities
$Nodes
3 5 5 2000000000
2 1 1 2
10
7
0 0 0 0.5 0.5
1 0 0 0.25 0.5
3 1 0 0
3 2 0 3
300
2000000000
5
0 1 0
0 0 1
1 1 1
$EndNodes
$Elements
3 3 1 9
2 1 2 1
1 10 7 300
3 1 4 1
3 10 7 300 2000000000
3 2 4 1
9 7 300 2000000000 5
$EndElements
$NodeData
1
"left out"
$EndNodeData
)";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

MeshReport read_text(const std::string& name, std::string_view text) {
  const TempFolder folder;
  folder.write(name, text);
  return read_any(folder.path(), name);
}

void expect_two_tets(const MeshReport& r) {
  EXPECT_EQ(r.nodes, 5);
  EXPECT_EQ(r.elements, 2);
  EXPECT_NEAR(r.volume, 0.5, 1e-15);
}

}  // namespace

TEST(Readers, Gmsh22TakesTetrahedraAmongOthersWithSparseTags) {
  expect_two_tets(read_text("two.msh", kGmsh22));
}

TEST(Readers, Gmsh41TakesSeveralBlocksAndParametricNodes) { expect_two_tets(read_text("two.msh", kGmsh41)); }

TEST(Readers, GmshEndingsOfOtherSystemsAreRead) {
  std::string text = kGmsh41;
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2)
    text.replace(at, 1, "\r\n");
  expect_two_tets(read_text("TWO.MSH", "\xEF\xBB\xBF" + text));
}

TEST(Readers, Gmsh22ParametricNodesAreRead) {
  expect_two_tets(read_text("two.msh", R"($MeshFormat
2.1 0 8
$EndMeshFormat
$ParametricNodes
5
1 0 0 0 2 1 0.5 0.5
2 1 0 0 2 1 0.5 0.5
3 0 1 0 2 1 0.5 0.5
4 0 0 1 3 1
5 1 1 1 1 1 0.3
$EndParametricNodes
$Elements
2
1 4 2 0 1 1 2 3 4
2 4 2 0 1 2 3 4 5
$EndElements
)"));
}

TEST(Readers, NodesKeepTheirPlaceAndElementsTheirNodes) {
  const TempFolder folder;
  folder.write("two.msh", kGmsh22);
  const TetMesh mesh = tet_mesh(file_spec("two.msh"), folder.path());
  EXPECT_EQ(mesh.nodes.col(4), Vec3(1, 1, 1));
  EXPECT_EQ(mesh.tets.col(0), Eigen::Vector4i(0, 1, 2, 3));
  EXPECT_EQ(mesh.tets.col(1), Eigen::Vector4i(1, 2, 3, 4));
}

TEST(Readers, ScaleMultipliesCoordinates) {
  const TempFolder folder;
  folder.write("two.msh", kGmsh22);
  MeshSpec spec = file_spec("two.msh");
  spec.scale = 1e-3;
  MeshReport r;
  tet_mesh(spec, folder.path(), &r);
  EXPECT_NEAR(r.volume, 0.5e-9, 1e-24);
  spec.scale = 0;
  expect_contains(error_of([&] { tet_mesh(spec, folder.path()); }), "scale = 0 must be positive");
}

TEST(Readers, AFileInOtherUnitsIsAskedAboutWhereNoScaleIsGiven) {
  const TempFolder folder;
  std::string text = kGmsh22,
              surface = "v 0 0 0\nv 80 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  folder.write("large.msh", replaced(text, "7 1 0 0", "7 120 0 0"));
  folder.write(
      "small.msh",
      replaced(replaced(replaced(replaced(text, "7 1 0 0", "7 1e-4 0 0"), "300 0 1 0", "300 0 1e-4 0"),
                        "2000000000 0 0 1", "2000000000 0 0 1e-4"),
               "5 1. 1.0e0 +1", "5 1e-4 1e-4 1e-4"));
  folder.write("tool.obj", surface);
  const auto refusal = [&](const char* name) {
    MeshSpec spec = file_spec(name);
    spec.scale.reset();
    return error_of([&] {
      if (std::string(name).ends_with(".obj"))
        mesh::surface(spec, folder.path());
      else
        tet_mesh(spec, folder.path());
    });
  };
  expect_contains(refusal("large.msh"),
                  "large.msh: the body is 120 m large; if this is intended, add scale = 1 to file = "
                  "\"large.msh\", or if the file is in millimetres, scale = 0.001");
  expect_contains(refusal("small.msh"), "the body is 0.0001 m large; if this is intended");
  expect_contains(refusal("small.msh"), "if the file is in kilometres, scale = 1000");
  expect_contains(refusal("tool.obj"), "tool.obj: the tool is 80 m large");
  MeshSpec spec = file_spec("large.msh");
  for (const double scale : {1.0, 1e-3}) {
    spec.scale = scale;
    EXPECT_NO_THROW(tet_mesh(spec, folder.path()));
  }
}

TEST(Readers, TetGenCountsFromZeroOrOneWithCommentsAttributesAndMarkers) {
  const TempFolder folder;
  folder.write("one.node",
               "# made by hand\n5 3 1 1\n\n1 0 0 0 0.5 1\n2 1 0 0 0.5 1 # corner\n3 0 1 0 0.5 1\n4 0 0 1 0.5 "
               "0\n5 1 1 1 0.5 0\n");
  folder.write("one.ele", "2 4 1\n1 1 2 3 4 7\n2 2 3 4 5 7\n# end\n");
  expect_two_tets(read_any(folder.path(), "one.node"));
  expect_two_tets(read_any(folder.path(), "one.ele"));
  folder.write("zero.node", "5 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n4 1 1 1\n");
  folder.write("zero.ele", "2 4 0\n0 0 1 2 3\n1 1 2 3 4\n");
  expect_two_tets(read_any(folder.path(), "zero.ele"));
}

namespace {

/// Returns "NAME: ELEMENTS; " for each region.
std::string regions_of(const std::string& name, std::string_view text, const std::string& other = "",
                       std::string_view other_text = "") {
  const TempFolder folder;
  folder.write(name, text);
  if (!other.empty()) folder.write(other, other_text);
  std::vector<MaterialRegion> regions;
  tet_mesh(file_spec(name), folder.path(), nullptr, &regions);
  std::string out;
  for (const MaterialRegion& region : regions)
    out += fmt::format("{}: {}; ", region.name, fmt::join(region.tets, " "));
  return out;
}

}  // namespace

TEST(Readers, PhysicalVolumesAreRegions) {
  const std::string first = "\n3 4 2 0 1 10 7 300 2000000000", second = "\n9 4 0 7";
  EXPECT_EQ(regions_of("a.msh", kGmsh22), "region-0: 1; region-1: 0; ")
      << "no physical group: the volumes of the model, none is 0";
  const std::string tissue = replaced(kGmsh22, first, "\n3 4 2 1 5 10 7 300 2000000000");
  EXPECT_EQ(regions_of("a.msh", tissue), "tissue: 0; ");
  EXPECT_EQ(regions_of("a.msh", replaced(tissue, second, "\n9 4 3 -12 5 0 7")), "tissue: 0; region-12: 1; ");
  EXPECT_EQ(regions_of("a.msh", replaced(tissue, second, "\n9 4 2 1 7 7")), "tissue: 0 1; ")
      << "one named region of all is one";
  EXPECT_EQ(regions_of("a.msh", replaced(replaced(tissue, second, "\n9 4 2 1 7 7"), "3 1 \"tissue\"",
                                         "2 1 \"tissue\"")),
            "")
      << "that is the name of a surface";

  EXPECT_EQ(regions_of("b.msh", kGmsh41), "region-1: 0; region-2: 1; ") << "volumes of the model";
  const std::string physical = replaced(kGmsh41, "0 0 0 1\n1 0 0 0 1 1 1 0 0\n",
                                        "1 0 0 2\n1 0 0 0 0\n1 0 0 0 1 1 1 2 7 8 0\n2 0 0 0 1 1 1 0 0\n");
  EXPECT_EQ(regions_of("b.msh", physical), "region-7: 0; region-8: 0; ") << "both; the other volume has none";
  EXPECT_EQ(
      regions_of(
          "b.msh",
          replaced(
              physical, "$Entities",
              "$PhysicalNames\n2\n2 7 \"a side\"\n3 7 \"bone of the leg\"\n$EndPhysicalNames\n$Entities")),
      "bone of the leg: 0; region-8: 0; ");
  EXPECT_NE(error_of([&] {
              regions_of("b.msh", replaced(physical, "$Entities",
                                           "$PhysicalNames\n1\n3 7 bone\n$EndPhysicalNames\n$Entities"));
            }).find("b.msh:6: a name in double quotes is expected, found bone"),
            std::string::npos);
}

TEST(Readers, AnElementInSeveralGroupsIsOneElement) {
  std::string text = replaced(kGmsh22, "\n1\n3 1 \"tissue\"\n", "\n2\n3 1 \"tissue\"\n3 4 \"all\"\n");
  text = replaced(text, "$Elements\n4", "$Elements\n5");
  text = replaced(text, "\n3 4 2 0 1 10 7 300 2000000000\n9 4 0 7",
                  "\n3 4 2 1 5 10 7 300 2000000000\n4 4 2 4 5 10 7 300 2000000000\n9 4 2 4 6 7");
  EXPECT_EQ(regions_of("a.msh", text), "tissue: 0; all: 0 1; ");
  expect_two_tets(read_text("a.msh", text));
  // the same group twice: the file contains a part twice
  expect_contains(error_of([&] { read_text("a.msh", replaced(text, "\n4 4 2 4", "\n4 4 2 1")); }),
                  "has the same corners as");
}

TEST(Readers, PartsOfPartitionedVolumesKeepTheirGroups) {
  const std::string parts =
      replaced(kGmsh41, "$EndEntities\n",
               "$EndEntities\n$PartitionedEntities\n2\n1\n9 1\n1 0 0 2\n5 3 1 1 1 0 0 0 0\n"
               "1 3 1 1 1 0 0 0 1 1 1 2 7 8 0\n2 3 1 2 2 1 0 0 0 1 1 1 0 0\n$EndPartitionedEntities\n");
  EXPECT_EQ(regions_of("b.msh", parts), "region-7: 0; region-8: 0; ");
  // a part without groups belongs to those of its volume
  EXPECT_EQ(regions_of("b.msh", replaced(parts, "1 0 0 0 1 1 1 0 0\n$EndE", "1 0 0 0 1 1 1 1 4 0\n$EndE")),
            "region-4: 1; region-7: 0; region-8: 0; ");
  // without groups both belong to the model's single volume
  EXPECT_EQ(regions_of("b.msh", replaced(parts, "1 1 1 2 7 8 0", "1 1 1 0 0")), "");
}

TEST(Readers, GroupsOfOneNameAreOneRegion) {
  EXPECT_EQ(regions_of_groups({{1, {0, 2}}, {2, {1, 2}}, {5, {3}}}, {{1, "a"}, {2, "a"}}, 4).size(), 2u);
  EXPECT_EQ(regions_of_groups({{1, {0, 2}}, {2, {1, 2}}}, {{1, "a"}, {2, "a"}}, 4)[0].tets,
            (std::vector<int>{0, 1, 2}));
}

TEST(Readers, TetGensAttributesAreRegions) {
  const std::string nodes = "5 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n";
  EXPECT_EQ(regions_of("a.ele", "2 4 1\n1 1 2 3 4 7\n2 2 3 4 5 -1.5\n", "a.node", nodes),
            "region--1.5: 1; region-7: 0; ");
  EXPECT_EQ(regions_of("a.ele", "2 4 1\n1 1 2 3 4 7\n2 2 3 4 5 7\n", "a.node", nodes), "")
      << "all alike: it says nothing";
  EXPECT_EQ(regions_of("a.ele", "2 4 0\n1 1 2 3 4\n2 2 3 4 5\n", "a.node", nodes), "");
  EXPECT_EQ(regions_of("a.ele", "2 4\n1 1 2 3 4\n2 2 3 4 5\n", "a.node", nodes), "");
}

TEST(Readers, ARegionHasEachElementOnce) {
  const std::vector<MaterialRegion> regions = {{"a", {0, 2}}, {"b", {3}}};
  EXPECT_EQ(region_of_element(regions, 5), (std::vector<int>{0, -1, 0, 1, -1}));
  // elements in both belong to the smaller one, whichever is listed first
  EXPECT_EQ(region_of_element({{"part", {2}}, {"all", {0, 1, 2, 3, 4}}}, 5),
            (std::vector<int>{1, 1, 0, 1, 1}));
  EXPECT_THROW(region_of_element(regions, 3), std::exception);
}

TEST(Readers, ObjJoinsContinuedLines) {
  const std::string text =
      "# a folder: C:\\\nv 0 0 0\nv 1 \\\n0 \\\r\n 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 \\\n1 "
      "\\\n4\n";
  EXPECT_NEAR(read_text("a.obj", text).volume, 1.0 / 6, 1e-15);
  // lines are counted as in the file, and a joined line by its first
  expect_contains(error_of([&] { read_text("a.obj", replaced(text, "3 \\\n1 \\\n4", "3 \\\n1 \\\nx")); }),
                  "a.obj:11: face 4: corner \"x\"");
  std::string old = text;
  std::erase(old, '\r');
  std::replace(old.begin(), old.end(), '\n', '\r');
  EXPECT_NEAR(read_text("a.obj", old).volume, 1.0 / 6, 1e-15)
      << "lines that end with a carriage return alone";
}

TEST(Readers, ObjTakesPolygonsNormalsTexturesAndNegativeIndices) {
  const std::string vertices =
      "mtllib a.mtl\no cube\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0 0.5 0.5 0.5\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 "
      "1\nv 0 1 1\n"
      "vt 0 0\nvn 0 0 1\ng side\nusemtl red\ns off\n";
  for (const char* faces :
       {"f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n",
        "f 4/1 3/1 2/1 1/1\nf 5/1/1 6/1/1 7/1/1 8/1/1\nf 1//1 2//1 6//1 5//1 # quad\nf 2 3 7 6\nf 3 4 8 7\nf "
        "4 1 5 8\n",
        "f -5 -6 -7 -8\nf -4 -3 -2 -1\nf -8 -7 -3 -4\nf -7 -6 -2 -3\nf -6 -5 -1 -2\nf -5 -8 -4 -1\n"}) {
    const MeshReport r = read_text("cube.obj", vertices + faces);
    EXPECT_EQ(r.nodes, 8);
    EXPECT_EQ(r.elements, 12);
    EXPECT_EQ(r.flipped, 0);
    EXPECT_NEAR(r.volume, 1.0, 1e-15);
  }
}

TEST(Readers, AbsolutePathsIgnoreTheFolder) {
  const TempFolder folder;
  folder.write("two.msh", kGmsh22);
  expect_two_tets(read_any("/nowhere", folder.path() + "/two.msh"));
}

TEST(Readers, WrongKindsOfFileAreRefusedWithAWayOut) {
  const TempFolder folder;
  expect_contains(error_of([&] { tet_mesh(file_spec("no.msh"), folder.path()); }),
                  "no.msh: no such file; check the path");
  expect_contains(error_of([&] { tet_mesh(file_spec("cow.obj"), folder.path()); }),
                  "an .obj contains a surface");
  expect_contains(error_of([&] { tet_mesh(file_spec("cow.obj"), folder.path()); }), "palpate model ");
  expect_contains(error_of([&] { tet_mesh(file_spec("cow.stl"), folder.path()); }),
                  "unknown ending \".stl\"");
  expect_contains(error_of([&] { tet_mesh(file_spec("cow.stl"), folder.path()); }),
                  "palpate model makes a model of STL");
  expect_contains(error_of([&] { surface(file_spec("ball.msh"), folder.path()); }),
                  "unknown ending \".msh\" for a surface");
  std::filesystem::create_directories(folder.path() + "/folder.msh");
  expect_contains(error_of([&] { tet_mesh(file_spec("folder.msh"), folder.path()); }), "no such file");
}
