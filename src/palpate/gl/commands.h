#pragma once
#include <cstddef>

namespace palpate::gl {

class Buffer;
class MappedBuffer;
class Program;
class VertexArray;

/// Which fragment of a pixel stays.
enum class Keep { kAll, kLeastDepth, kGreatestDepth };

/// The whole fixed-function state of a plain pass over triangles, so that nothing an earlier pass left on
/// matters: no blending, culling, scissor, stencil, offset or clamping, all masks open, filled polygons,
/// depth range [0, 1], viewport (0, 0, width, height).
void set_plain_state(int width, int height, Keep keep);

/// After set_plain_state: leaves out triangles whose corners run counter-clockwise on the screen (or
/// clockwise).
void cull(bool leave_out_counter_clockwise);

/// Draws index_count / 3 triangles of a vertex array that has indices,
/// with the program in use, into the bound framebuffer.
void draw_triangles(const VertexArray& vertices, std::size_t index_count);

/// After set_plain_state: viewport and scissor are this rectangle of the target, which clears obey, too.
void set_window(int x, int y, int width, int height);

/// Draws `count` ranges of a vertex array's indices at once; each is a record of glMultiDrawElementsIndirect,
/// `stride` bytes apart, from byte `offset` of a buffer.
void draw_ranges(const VertexArray& vertices, const MappedBuffer& ranges, std::size_t offset,
                 std::size_t count, std::size_t stride);

/// Copies the first bytes of one buffer to another, after what compute programs have written to it.
void copy(const Buffer& from, MappedBuffer& to, std::size_t bytes);

/// Waits until the GPU has done all that it was told, and mapped buffers show it.
/// @throws ContextLost where it never will; InternalError when GL recorded an error; `what` names the work
void finish(const char* what);

int largest_texture();        ///< edge [pixels]
int vertex_storage_blocks();  ///< that a vertex shader may read

/// Runs a compute program over groups; buffers that it wrote may be read or drawn from afterwards.  Textures
/// that the last pass drew are unbound as targets first.
void dispatch(const Program& program, int groups_x, int groups_y, int groups_z = 1);

}  // namespace palpate::gl
