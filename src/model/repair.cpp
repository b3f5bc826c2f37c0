#include "model/repair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "crossings.h"
#include "mend.h"
#include "mesh/surface_checks.h"
#include "palpate/core/error.h"
#include "palpate/mesh/boundary.h"
#include "shells.h"
#include "soup.h"
#include "wrap.h"

namespace palpate::model {
namespace {

constexpr double kWeld = 1e-6;                                 // [diagonals]
constexpr double kWrapAlpha = 0.01, kWrapOffset = 1.0 / 1500;  // [diagonals]
// Largest share of the volume that cutting out intersecting faces may change; beyond it, the wrap is closer
// to the intended shape.
constexpr double kLargestRemoval = 0.05;

void note(std::vector<std::string>& notes, int count, const std::string& what) {
  if (count > 0) notes.push_back(fmt::format("{} {}", count, what));
}

/// Returns the number of edges with one face.
int open_edges(const Soup& soup) {
  std::map<std::array<int, 2>, int> faces_at;
  for (const auto& f : soup.faces)
    for (std::size_t k = 0; k < 3; ++k)
      ++faces_at[{std::min(f[k], f[(k + 1) % 3]), std::max(f[k], f[(k + 1) % 3])}];
  return static_cast<int>(
      std::count_if(faces_at.begin(), faces_at.end(), [](const auto& edge) { return edge.second == 1; }));
}

/// Merges vertices that are closer than single-precision rounding, only if the surface is otherwise open and
/// the merge closes edges: seams between separately written parts.
int weld_seams(Soup& soup) {
  const int before = open_edges(soup);
  if (before == 0) return 0;
  Soup welded = soup;
  const int count = weld(welded, kWeld * soup.diagonal());
  if (count == 0) return 0;
  drop_collapsed(welded);
  drop_duplicates(welded);
  drop_unused(welded);
  if (open_edges(welded) >= before) return 0;
  soup = welded;
  return count;
}

double absolute_volume(const Soup& soup) { return std::abs(mesh::enclosed_volume(soup.surface())); }

Soup wrap(const Soup& soup, const std::vector<int>& crossing, const RepairOptions& options,
          std::vector<std::string>& notes) {
  if (!options.wrap)
    fail(
        "{}: this face and {} others intersect, and cutting them out did not help; repair the surface there, "
        "or omit --no-wrap",
        soup.face_name(crossing[0]), crossing.size() - 1);
  if (options.place) options.place(soup.face_name(crossing[0]));
  const double diagonal = soup.diagonal(), before = absolute_volume(soup);
  Soup out = wrapped(soup, kWrapAlpha * diagonal, kWrapOffset * diagonal);
  if (out.faces.empty())
    fail("{}: this face and {} others intersect, and the surface could not be wrapped",
         soup.face_name(crossing[0]), crossing.size() - 1);
  notes.push_back(
      fmt::format("the surface still intersected itself at {} faces, first {}: it was wrapped at {:.3g} m, "
                  "which smooths details below {:.3g} m; volume {:.6g} -> {:.6g} m^3",
                  crossing.size(), soup.face_name(crossing[0]), kWrapOffset * diagonal, kWrapAlpha * diagonal,
                  before, absolute_volume(out)));
  return out;
}

}  // namespace

RepairedSurface repair(const TriMesh& faces, const mesh::Provenance& from, const RepairOptions& options,
                       const Progress& progress) {
  const auto tell = [&](double fraction) {
    if (progress) progress(fraction);
  };
  RepairedSurface out;
  Soup soup = soup_of(faces, from);
  note(out.notes, weld(soup, 0.0), "coincident vertices were merged");
  note(out.notes, drop_collapsed(soup), "collapsed faces were removed");
  note(out.notes, drop_duplicates(soup), "duplicate faces were removed");
  note(out.notes, drop_unused(soup), "unused vertices were removed");
  if (soup.faces.empty()) fail("{}: no face has three different corners", from.source);
  note(out.notes, weld_seams(soup), "vertices along seams were merged, 1e-6 of the diagonal apart at most");
  tell(0.2);
  note(out.notes, orient_consistently(soup), "faces were reoriented to agree with their neighbours");
  const double meant = absolute_volume(soup);
  Mended mended = mend(soup, options.largest_hole, options.place);
  if (mended.holes > 0)
    out.notes.push_back(fmt::format("{} holes were closed by {} faces", mended.holes, mended.hole_faces));
  note(out.notes, mended.removed, "needles and flat faces were collapsed");
  tell(0.7);
  std::vector<int> crossing = crossing_faces(mended.soup);
  const bool cut_too_much =
      mended.holes == 0 && std::abs(absolute_volume(mended.soup) - meant) > kLargestRemoval * meant;
  const bool wrap_original = crossing.empty() && cut_too_much;
  if (wrap_original) crossing = crossing_faces(soup);
  if (!crossing.empty()) {
    soup = wrap(wrap_original ? soup : mended.soup, crossing, options, out.notes);
  } else {
    note(out.notes, mended.crossings, "intersecting faces were cut out and the holes closed");
    soup = std::move(mended.soup);
  }
  soup = keep_one_body(soup, options.largest_shell, out.notes);
  tell(0.9);
  out.surface = soup.surface();
  mesh::check_surface(out.surface, mesh::surface_provenance(from.source + " (repaired)"));
  tell(1.0);
  return out;
}

}  // namespace palpate::model
