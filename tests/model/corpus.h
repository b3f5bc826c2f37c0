#pragma once
// For any surface, model generation ends within its budget: with a model, or with an error that gives a
// location and a remedy.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <regex>

#include "broken_surfaces.h"
#include "core/clock.h"
#include "mesh/surface_checks.h"
#include "palpate/core/error.h"
#include "palpate/mesh/boundary.h"

namespace broken {

struct Share {
  int all = 0, models = 0, meant_to_be = 0;
};

/// Checks the requirements on a model from any surface: it passed the quality gate, and is bounded by a
/// closed surface.
inline void expect_sound(const model::Made& made) {
  mesh::Provenance from;
  from.source = "boundary of the model";
  TriMesh skin = mesh::boundary(made.file.model.tets).surface;
  EXPECT_NO_THROW(mesh::check_surface(skin, from));
  EXPECT_LE(made.quality.volume_error, 0.01);
  if (!made.angle_cost) { EXPECT_GE(made.quality.smallest_dihedral_deg, made.creased ? 4.0 : 8.0); }
}

/// Checks that an error gives a location (except for insufficient budgets) and a remedy.
inline void expect_a_way_out(const std::string& refusal) {
  static const std::regex place(R"(at \(.*\) m|(vertex|face|element) \d+|--limit-s|--points)"),
      way_out("--[a-z]+|write the surface again|mesh again|the surface of a body must be closed");
  EXPECT_TRUE(std::regex_search(refusal, place)) << refusal;
  EXPECT_TRUE(std::regex_search(refusal, way_out)) << refusal;
}

inline Share make_all(const std::function<bool(const broken::Entry&)>& requested) {
  Share share;
  for (const broken::Entry& entry : broken::entries()) {
    if (!requested(entry)) continue;
    SCOPED_TRACE(entry.name);
    model::Options options = entry.options;
    options.tetrahedra.tetrahedra = entry.tetrahedra;
    options.tetrahedra.at_least = true;
    options.proxies = 0;
    model::ProgressListener silent;
    const double start = wall_seconds();
    std::string outcome = "model";
    try {
      expect_sound(model::make_model(entry.make(), options, silent));
    } catch (const Error& e) { outcome = e.what(); }
    ++share.all;
    share.models += outcome == "model";
    share.meant_to_be += entry.expected == "model";
    fmt::print("  {:44} {:5.1f} s  {}\n", entry.name, wall_seconds() - start, outcome);
    if (entry.expected == "model") {
      EXPECT_EQ(outcome, "model");
    } else {
      EXPECT_NE(outcome, "model");
      EXPECT_NE(outcome.find(entry.expected), std::string::npos) << outcome;
      expect_a_way_out(outcome);
    }
  }
  fmt::print("{} of {} surfaces became models, {} were meant to\n", share.models, share.all,
             share.meant_to_be);
  return share;
}

}  // namespace broken
