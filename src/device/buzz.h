#pragma once
#include "palpate/core/archive.h"
#include "palpate/core/pose.h"

namespace palpate::device {

/// Frequency above which a force is perceived as a vibration [Hz].
inline constexpr double kBuzzFrequency = 30.0;

/// Root mean square of the device's force above a cutoff frequency f_c, over the samples so far [N].
/// Butterworth high pass of fourth order along each axis, by the bilinear transform with frequency
/// prewarping: a tone of frequency f passes with |H|^2 = 1/(1 + (tan(pi f_c T)/tan(pi f T))^8), -3 dB at f_c.
/// A force that is constant from the first sample on gives exactly 0; a jump contributes, as it has a
/// spectrum.
class VibrationMeter {
 public:
  /// @param tick_s  T [s], with f_c T < 1/2  @param frequency_hz  f_c
  explicit VibrationMeter(double tick_s, double frequency_hz = kBuzzFrequency);
  /// Adds one sample of the force [N].
  void add(const Vec3& force);
  double rms() const;
  double largest() const { return largest_; }  ///< Largest magnitude of the filtered force [N].
  void archive(Archive& a);

 private:
  /// Second-order section, y = c (x - 2 x1 + x2) - a1 y1 - a2 y2.
  struct Section {
    double c, a1, a2;
    Vec3 x1 = Vec3::Zero(), x2 = Vec3::Zero(), y1 = Vec3::Zero(), y2 = Vec3::Zero();
    Vec3 operator()(const Vec3& x);
    void archive(Archive& a);
  };
  static Section section(double warped, double q);
  Section first_, second_;
  bool started_ = false;
  double sum_ = 0.0, largest_ = 0.0;
  long count_ = 0;
};

}  // namespace palpate::device
