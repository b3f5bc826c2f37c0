#pragma once
#include <cstddef>

namespace palpate::gl {

class Buffer;
class MappedBuffer;
class Program;
class VertexArray;

/// Depth test: fragment of a pixel that is kept.
enum class Keep { kAll, kLeastDepth, kGreatestDepth };

/// Sets the whole fixed-function state of a plain triangle pass, independent of earlier passes: no blending,
/// culling, scissor, stencil, offset or clamping, all masks open, filled polygons, depth range [0, 1],
/// viewport (0, 0, width, height).
void set_plain_state(int width, int height, Keep keep);

/// After set_plain_state(): culls triangles that are counter-clockwise on the screen (or clockwise).
void cull(bool leave_out_counter_clockwise);

/// Draws index_count / 3 triangles of an indexed vertex array with the current program into the bound
/// framebuffer.
void draw_triangles(const VertexArray& vertices, std::size_t index_count);

/// After set_plain_state(): sets viewport and scissor to this rectangle of the target; clears are also
/// limited to it.
void set_window(int x, int y, int width, int height);

/// Draws `count` index ranges of a vertex array in one call; each has the layout of
/// glMultiDrawElementsIndirect, `stride` bytes apart, from byte `offset` of a buffer.
void draw_ranges(const VertexArray& vertices, const MappedBuffer& ranges, std::size_t offset,
                 std::size_t count, std::size_t stride);

/// Copies the first bytes of one buffer to another, after compute programs have written to it.
void copy(const Buffer& from, MappedBuffer& to, std::size_t bytes);

/// Waits until the GPU has completed all commands and their results are visible in mapped buffers.
/// @param what  name of the work, for messages
/// @throws ContextLost where the GPU was reset or does not finish within a minute; InternalError when GL
///   recorded an error
void finish(const char* what);

int largest_texture();        ///< Largest edge of a texture [pixels].
int vertex_storage_blocks();  ///< Number of storage blocks that a vertex shader may read.

/// Runs a compute program over groups; buffers that it wrote may be read or drawn from afterwards.  Unbinds
/// the framebuffer first, so that textures drawn by the last pass can be read.
void dispatch(const Program& program, int groups_x, int groups_y, int groups_z = 1);

}  // namespace palpate::gl
