#include <algorithm>
#include <set>
#include <vector>

#include "helpers.h"

namespace {

/// A broken file and the expected content of its error message: location, element, value, remedy.
struct Broken {
  std::string file;
  std::vector<std::string> fragments;
};

const std::vector<Broken> kBroken = {
    {"binary.msh", {"binary.msh:2: ", "file type 1", "convert it: gmsh "}},
    {"gmsh1.msh", {"gmsh1.msh:1: ", "Gmsh format 1 ($NOD)", "-format msh41"}},
    {"gmsh40.msh", {"gmsh40.msh:2: ", "Gmsh format 4 is not read, only 2.2 and 4.1", "-format msh41"}},
    {"not_gmsh.msh", {"not_gmsh.msh:1: ", "\"solid\"", "check that this is a .msh file of Gmsh"}},
    {"truncated.msh", {"truncated.msh:7: ", "the file ends where a node should follow", "truncated"}},
    {"huge_count.msh",
     {"huge_count.msh:5: ", "number of nodes = 99999999999, but only", "truncated, or the count is wrong"}},
    {"negative_count.msh", {"negative_count.msh:12: ", "number of elements = -1 is negative"}},
    {"small_count.msh",
     {"small_count.msh:9: ", "$EndNodes is expected, found \"4\"", "count of its entries is wrong"}},
    {"nan.msh", {"nan.msh:8: node 3: ", "y = nan is not finite", "write the mesh again"}},
    {"overflow.msh", {"overflow.msh:9: node 4: ", "z = 1e999 is not finite"}},
    {"word.msh", {"word.msh:7: node 2: ", "z = \"zero\" is not a number"}},
    {"missing_node.msh", {"missing_node.msh:13: element 7: ", "node 9 is not in the file", "4 nodes"}},
    {"five_corners.msh", {"five_corners.msh:13: element 7: ", "\"5\" is one entry too many"}},
    {"twice_a_node.msh", {"twice_a_node.msh:13: element 7 is degenerate", "node 3 twice", "mesh again"}},
    {"flat.msh", {"flat.msh:15: element 8 is degenerate", "volume = 0 m^3", "mesh again"}},
    {"duplicate_element.msh",
     {"duplicate_element.msh:14: element 8 has the same corners as", ":13: element 7", "remove one"}},
    {"unreferenced.msh",
     {"unreferenced.msh:10: node 5 (one of 1) belongs to no tetrahedron", "Physical Volume"}},
    {"three_on_a_face.msh",
     {"three_on_a_face.msh:17: element 9 is the third element on the face of node 1, node 2, node 3",
      "mesh again"}},
    {"only_triangles.msh", {"only_triangles.msh: the mesh has no tetrahedra", "-3"}},
    {"second_order.msh", {"second_order.msh: its 1 tetrahedra are of second order", "Mesh.ElementOrder = 1"}},
    {"huge_block.msh", {"huge_block.msh:6: ", "number of nodes in the block = 4000000000, but only"}},
    {"blocks_disagree.msh",
     {"blocks_disagree.msh:14: ", "4 nodes are in the blocks, but the section announces 5"}},
    {"duplicate_tag.msh", {"duplicate_tag.msh:14: node 2 is defined here and in line 12", "must differ"}},
    {"missing_end.msh", {"missing_end.msh:15: ", "$EndNodes is expected, found \"$Elements\""}},
    {"crossed.obj", {"crossed.obj:25: face 9: ", "crosses or touches itself", "cut it into triangles"}},
    {"flat_world.ele", {"flat_world.node:1: ", "dimension = 2 must be 3"}},
    {"out_of_range.ele", {"out_of_range.ele:2: element 1: ", "node 5 is outside 1 to 4"}},
    {"gap.node", {"gap.node:4: ", "point 4 found where 3 is expected", "must be consecutive"}},
    {"no_elements.node", {"no_elements.ele: no such file"}},
    {"ten_nodes.ele", {"ten_nodes.ele:1: ", "10 nodes per tetrahedron", "without -o2"}},
    {"two_tets_announced.ele",
     {"two_tets_announced.ele:2: ", "the file ends where a tetrahedron should follow"}},
    {"open.obj",
     {"open.obj:5: face 1: the edge from vertex 1 to vertex 3 belongs to no other face", "fill the hole"}},
    {"three_faces.obj", {"three_faces.obj:", "the edge from vertex 1 to vertex 2 belongs to 3 faces"}},
    {"zero_index.obj", {"zero_index.obj:5: face 1: ", "corner \"0\": vertices are counted from 1"}},
    {"no_such_vertex.obj", {"no_such_vertex.obj:9: face 5: vertex 8 is not in the file; it has 4 vertices"}},
    {"before_the_first.obj",
     {"before_the_first.obj:5: face 1: ", "corner \"-5\" is out of range; 4 vertices precede"}},
    {"two_corners.obj", {"two_corners.obj:5: face 1: it has 2 corners, a face has at least 3"}},
    {"not_a_number.obj", {"not_a_number.obj:1: vertex 1: ", "y = \"0,5\" is not a number"}},
    {"unreferenced_vertex.obj",
     {"unreferenced_vertex.obj:5: vertex 5 (one of 1) belongs to no face", "delete"}},
    {"same_face_twice.obj",
     {"same_face_twice.obj:9: face 5 has the same corners as", ":5: face 1", "remove one"}},
    {"needle.obj", {"needle.obj:5: face 1 is degenerate: area = 0 m^2", "collapse"}},
    {"empty.obj", {"empty.obj: the surface has no faces"}},
    {"one_sided.obj", {"one_sided.obj:", "cannot be oriented", "repair it"}},
};

}  // namespace

TEST(BrokenMeshes, AreRefusedWithFilePlaceValueAndRemedy) {
  int checked = 0;
  for (const auto& broken : kBroken) {
    const std::string message = error_of([&] { read_any(PALPATE_BROKEN_MESHES, broken.file); });
    for (const auto& fragment : broken.fragments) expect_contains(message, fragment);
    ++checked;
  }
  EXPECT_EQ(checked, 43);
}

TEST(BrokenMeshes, EachFileOfTheFolderIsInTheTable) {
  std::set<std::string> stems;
  for (const auto& broken : kBroken) stems.insert(std::filesystem::path(broken.file).stem().string());
  for (const auto& entry : std::filesystem::directory_iterator(PALPATE_BROKEN_MESHES))
    EXPECT_EQ(stems.count(entry.path().stem().string()), 1u) << entry.path();
}
