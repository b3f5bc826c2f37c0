#pragma once

namespace palpate::contact {

/// How much of each thing one query goes through.
struct QueryCounts {
  double nodes = 0.0;           ///< of the soft bodies
  double faces = 0.0;           ///< of both skins that pruning hands on
  double image_vertices = 0.0;  ///< of both sides in axes, of all images (QueryStages::vertices)
  double image_faces = 0.0;     ///< that these images show (QueryStages::faces)
  double pixels = 0.0;          ///< of all images that are in the processor's memory
  double pairs = 0.0;           ///< of faces, of all images
  double hits = 0.0;            ///< of these, the ones near enough
  double sample_bytes = 0.0;    ///< ContactForce::sample_bytes
};

/// What a query reads from memory and writes to it [bytes], where each stage writes what it hands to the next
/// once and reads what it is handed once, and all that it needs in between stays in caches.  Against the
/// bandwidth of copying it says how far from the memory's speed a query is.  Left out are the proxies (a few
/// dozen hulls a body) and what exact lines sort.  The source derives it.
double query_bytes(const QueryCounts& counts);

}  // namespace palpate::contact
