#pragma once
#include "palpate/core/types.h"
#include "palpate/shapes/shapes.h"

namespace palpate::shapes {

/// What of a head is made.
struct HeadParts {
  bool fine = true;         ///< eyes, lids, lips, ears in detail, hair; else what bounds the tetrahedra
  bool neck = true;         ///< cut level below
  double wavelength = 0.0;  ///< of the finest relief [mm]; 0: none
};

/// A head that measures 240 from chin to crown, in millimetres: the origin between the eyes' level and the
/// ears, crown at z = 120, chin at z = -120. Mirror image of itself about x = 0.
double head_mm(const Vec3& place, const HeadParts& parts);
/// Wanted edge length there, as a factor: less at the eyes, nose, mouth and ears.
double head_size_mm(const Vec3& place);

Shape make_head(const Resolution& resolution);

}  // namespace palpate::shapes
