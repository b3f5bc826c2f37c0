#pragma once
#include <cstddef>

namespace palpate::gl {

class Program;
class VertexArray;

/// Which fragment of a pixel stays.
enum class Keep { kAll, kLeastDepth, kGreatestDepth };

/// The whole fixed-function state of a plain pass over triangles, so that nothing an earlier pass left on
/// matters: no blending, culling, scissor, stencil, offset or clamping, all masks open, filled polygons,
/// depth range [0, 1], viewport (0, 0, width, height).
void set_plain_state(int width, int height, Keep keep);

/// After set_plain_state: leaves out triangles whose corners run counter-clockwise on the screen (or
/// clockwise), and counts in the stencil every fragment of the others, kept or not.
void cull_and_count(bool leave_out_counter_clockwise);

/// Draws index_count / 3 triangles of a vertex array that has indices,
/// with the program in use, into the bound framebuffer.
void draw_triangles(const VertexArray& vertices, std::size_t index_count);

/// Runs a compute program over groups; buffers that it wrote may be read or drawn from afterwards.  Textures
/// that the last pass drew are unbound as targets first.
void dispatch(const Program& program, int groups_x, int groups_y, int groups_z = 1);

}  // namespace palpate::gl
