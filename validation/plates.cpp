#include "plates.h"

#include <cmath>

#include "palpate/mesh/generators.h"

namespace palpate::validation {

namespace {
constexpr double kPi = 3.14159265358979323846;
}

double Plates::wave_number() const { return 2.0 * kPi / wavelength; }
double Plates::overlap_amplitude(double x0) const {
  return 2.0 * amplitude * std::sin(0.5 * wave_number() * x0);
}

double Plates::volume(double x0, double h) const {
  const double A = overlap_amplitude(x0), f = std::acos(h / A);
  return kIslands * 4.0 * A * A / (slope * wave_number()) *
         (0.5 * f + 0.25 * f * std::cos(2.0 * f) - 0.375 * std::sin(2.0 * f));
}

double Plates::area(double x0, double h) const {
  const double A = overlap_amplitude(x0), f = std::acos(h / A);
  return kIslands * 4.0 * A / (slope * wave_number()) * (std::sin(f) - f * std::cos(f));
}

template <class Segment>
double Plates::over_facets(double x0, double h, Segment integral) const {
  const double cell = wavelength / cells, A = overlap_amplitude(x0), q = wave_number();
  const int shift = static_cast<int>(std::lround(x0 / cell)),
            count = static_cast<int>(std::lround(kLength * cells)) - shift;
  const auto depth = [&](int i) {
    const double x = -0.5 * kLength * wavelength + (shift + i) * cell;
    return A * std::cos(q * (x - 0.5 * x0)) - h;
  };
  double sum = 0.0;
  for (int i = 0; i < count; ++i) {
    double low = depth(i), high = depth(i + 1);
    if (low > high) std::swap(low, high);
    if (high <= 0.0) continue;
    const double part = low >= 0.0 ? 1.0 : high / (high - low);
    sum += part * cell * integral(std::max(low, 0.0), high);
  }
  return sum;
}

double Plates::facet_volume(double x0, double h) const {
  return over_facets(x0, h, [&](double d, double e) { return (d * d + d * e + e * e) / (3.0 * slope); });
}
double Plates::facet_area(double x0, double h) const {
  return over_facets(x0, h, [&](double d, double e) { return (d + e) / slope; });
}

TriMesh Plates::lower() const {
  TriMesh mesh = mesh::box_surface(Vec3(kLength * wavelength, kWidth, kThickness),
                                   {static_cast<int>(std::lround(kLength * cells)), 4, 1});
  for (auto x : mesh.vertices.colwise()) {
    const bool top = x.z() > 0.0;
    x.z() -= 0.5 * kThickness;
    if (top) x.z() += amplitude * std::sin(wave_number() * x.x());
  }
  return mesh;
}

TriMesh Plates::upper(double x0, double h) const {
  TriMesh mesh = mesh::box_surface(Vec3(kLength * wavelength, kWidth, kThickness),
                                   {static_cast<int>(std::lround(kLength * cells)), 4, 1});
  for (auto x : mesh.vertices.colwise()) {
    const bool bottom = x.z() < 0.0;
    x.z() += 0.5 * kThickness + h;
    if (bottom) x.z() += amplitude * std::sin(wave_number() * x.x()) + slope * std::abs(x.y());
    x.x() += x0;
  }
  return mesh;
}

}  // namespace palpate::validation
