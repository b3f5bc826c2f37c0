#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "contact/carrier.h"
#include "palpate/contact/sample.h"

namespace palpate::contact {

/// Where both points of a sample are in the axes of its region at the query, from `at` of the carrier on side
/// a [m].
struct SamplePlace {
  double u, v, w_a, w_b;
};

/// The samples of one region that hang on the same carriers on both sides.
struct ContactCell {
  int a = -1, b = -1;       ///< carriers
  int first = 0, last = 0;  ///< places
  int pair = 0;             ///< ContactSample::source
  double area = 0.0;        ///< of each sample [m^2]; negative: each has its own
  Vec3 normal = Vec3::Zero();
};

/// Samples of image sources, 32 bytes each where all of a region stand for the same area: thousands of them
/// share a normal and what carries them.
struct SampleCells {
  std::vector<Carrier> carriers;
  std::vector<ContactCell> cells;
  std::vector<SamplePlace> places;  ///< by cell
  std::vector<double> areas;        ///< by place; empty where no cell needs it

  void clear();
  int count() const { return static_cast<int>(places.size()); }
  std::size_t bytes() const;  ///< of all that is kept
  double area(const ContactCell& cell, int place) const {
    return cell.area >= 0.0 ? cell.area : areas[static_cast<std::size_t>(place)];
  }
  /// One sample in full.
  ContactSample sample(const ContactCell& cell, int place) const;
  /// Appends all samples, or those of first_cell <= cell < last_cell.
  void append_to(std::vector<ContactSample>& samples) const { append_to(samples, 0, cells.size()); }
  void append_to(std::vector<ContactSample>& samples, std::size_t first_cell, std::size_t last_cell) const;
  /// Whether these samples stand for the same points, wherever they are now: the points of a frame slide.
  bool have_points_of(const SampleCells& other) const;
};

}  // namespace palpate::contact
