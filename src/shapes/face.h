#pragma once
#include "palpate/core/types.h"

/// Details of a head, right half (x >= 0), in millimetres in the axes of head_mm.  Each function takes the
/// distance to the head so far and returns it with the detail.
namespace palpate::shapes {

double with_eye(double head, const Vec3& p, bool fine);
double with_nose(double head, const Vec3& p, bool fine);
double with_mouth(double head, const Vec3& p, bool fine);
double with_ear(double head, const Vec3& p, bool fine);
/// Adds the hair.
/// @param wavelength  shortest wavelength of the strands [mm]; 0: smooth
double with_hair(double head, const Vec3& p, double wavelength);
/// Returns the height of the eyebrows [mm].
double eyebrow(const Vec3& p, double wavelength);
/// Returns the height of wrinkles and pores [mm].
double skin_relief(const Vec3& p, double wavelength);

}  // namespace palpate::shapes
