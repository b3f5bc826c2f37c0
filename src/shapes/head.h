#pragma once
#include "palpate/core/types.h"
#include "shapes/shapes.h"

namespace palpate::shapes {

/// Parts of a head.
struct HeadParts {
  bool fine = true;  ///< true: eyes, lids, lips, ears in detail, hair; false: boundary of the tetrahedra
  bool neck = true;  ///< with a neck, cut level below
  double wavelength = 0.0;  ///< shortest wavelength of the relief [mm]; 0: none
};

/// Returns the distance to a head that measures 240 from chin to crown, in millimetres.  The origin is
/// between the level of the eyes and the ears, crown at z = 120, chin at z = -120.  Symmetric about x = 0.
double head_mm(const Vec3& place, const HeadParts& parts);
/// Returns the target edge length as a factor: smaller at the eyes, nose, mouth and ears.
double head_size_mm(const Vec3& place);

/// Makes a head, 0.24 m from chin to crown.
Shape make_head(const Resolution& resolution);

}  // namespace palpate::shapes
