// In double precision, with indices of 32 bits, so that a point is 24 bytes:
//
//   node          position and velocity in the State, read; position kept by its side, written; position at
//                 the query before, read and written again (passed_vertices.h): 5 x 24                    120
//   face          its number, written and read; three corners, read; and as a triangulation has half as
//                 many vertices as faces, half of: tetrahedron and its corners, 4 + 16, four weights, 32,
//                 read, and the position, written:  8 + 12 + (20 + 32 + 24)/2                              58
//   image vertex  position, read; place in the axes, written and read by the image: 3 x 24                 72
//   image face    its number, written and read; three corners, read by the image: 8 + 12                   20
//   pixel         depth and triangle, 4 + 4, of two surfaces, cleared and read: 2 x 2 x 8                  32
//   pair          pixel and two faces, written and read: 2 x 12                                            24
//   hit           what facing.cpp found, written by it and read by what makes samples: 2 x sizeof(Hit)
//   samples       as they are kept, written
#include "palpate/contact/query_bytes.h"

#include "contact/depth_image.h"
#include "contact/sample_cells.h"
#include "contact/vertex_rule.h"

namespace palpate::contact {

static_assert(sizeof(FacePair) == 12, "the bytes of a pair are derived above");
static_assert(sizeof(Hit) == 104, "the bytes of a hit are derived from what it holds");
static_assert(sizeof(SamplePlace) == 32, "a sample is four numbers");

double query_bytes(const QueryCounts& counts) {
  return 120.0 * counts.nodes + 58.0 * counts.faces + 72.0 * counts.image_vertices +
         20.0 * counts.image_faces + 32.0 * counts.pixels + 24.0 * counts.pairs +
         2.0 * sizeof(Hit) * counts.hits + counts.sample_bytes;
}

}  // namespace palpate::contact
