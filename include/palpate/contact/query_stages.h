#pragma once
#include <concepts>
#include <cstddef>
#include <type_traits>

namespace palpate::contact {

/// Wall time of the queries of an image-space source by stage, accumulated since its construction [s].
struct QueryStages {
  /// Skin vertices from nodes, rigid surfaces from frames, as far as regions need them.
  double positions_s = 0.0;
  double regions_s = 0.0;      ///< Detection of the regions that may touch, and of their normals.
  double patches_s = 0.0;      ///< Faces of each region in contact axes, and its camera.
  double images_s = 0.0;       ///< Detection of opposite triangles. The following four are parts of it.
  double upload_s = 0.0;       ///< Surface data created for, or sent to, the GPU.
  double passes_s = 0.0;       ///< Rendering of both surfaces.
  double gather_s = 0.0;       ///< Comparison of both images, and compaction of the pairs into one list.
  double readback_s = 0.0;     ///< Remainder: commands, fence, and distribution of the list.
  double gaps_s = 0.0;         ///< Gaps in double precision, and samples.
  long images = 0, pairs = 0;  ///< Number of images, and of pairs of triangles in them.
  long pixels = 0;             ///< Pixels of all images.
  /// Vertices transformed to contact axes, of all images and both sides; faces visible in these images.
  long vertices = 0, faces = 0;
  long hits = 0;  ///< Samples.
};

/// Calls f(name, member) for every member, in the order of their declaration. The type gives the unit: long
/// is a count, double is wall time [s].
template <class F, class Stages>
requires(std::same_as<std::remove_const_t<Stages>, QueryStages>) constexpr void visit_counters(F&& f,
                                                                                               Stages& s) {
  f("positions_s", s.positions_s);
  f("regions_s", s.regions_s);
  f("patches_s", s.patches_s);
  f("images_s", s.images_s);
  f("upload_s", s.upload_s);
  f("passes_s", s.passes_s);
  f("gather_s", s.gather_s);
  f("readback_s", s.readback_s);
  f("gaps_s", s.gaps_s);
  f("images", s.images);
  f("pairs", s.pairs);
  f("pixels", s.pixels);
  f("vertices", s.vertices);
  f("faces", s.faces);
  f("hits", s.hits);
}
static_assert(
    [] {
      std::size_t bytes = 0;
      const QueryStages zero;
      visit_counters([&bytes](const char*, const auto& value) { bytes += sizeof value; }, zero);
      return bytes;
    }() == sizeof(QueryStages),
    "visit_counters() leaves out a member of QueryStages");

}  // namespace palpate::contact
