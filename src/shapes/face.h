#pragma once
#include "palpate/core/types.h"

/// Details of a head, right half (x >= 0), millimetres in the axes of head_mm.  Each takes the head so far
/// and gives it back with the detail.
namespace palpate::shapes {

double with_eye(double head, const Vec3& p, bool fine);
double with_nose(double head, const Vec3& p, bool fine);
double with_mouth(double head, const Vec3& p, bool fine);
double with_ear(double head, const Vec3& p, bool fine);
/// @param wavelength  of the finest strands [mm]; 0: smooth
double with_hair(double head, const Vec3& p, double wavelength);
/// How far the eyebrows stand out [mm].
double eyebrow(const Vec3& p, double wavelength);
/// Wrinkles and pores: how far the skin stands out [mm].
double skin_relief(const Vec3& p, double wavelength);

}  // namespace palpate::shapes
