#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "contact/depth_image.h"

namespace palpate::contact {

/// Lines along the normal, cut with every triangle that they may meet, in double precision: no image.  They
/// tell all layers, and are what images are held against.
class ExactLines {
 public:
  /// Through the middle of every pixel; the pairs' `at` is the pixel.
  void through_pixels(const Patch& a, const Patch& b, const ContactCamera& camera, double candidate_gap,
                      std::vector<FacePair>& pairs);
  /// Through points (u, v) of the plane; the pairs' `at` is the point's index.  Ascending by it, the pairs of
  /// one line by height.
  /// @param camera  its pixels are the bins that triangles look for points in; points outside of it are none
  void through(std::span<const Eigen::Vector2d> points, const Patch& a, const Patch& b,
               const ContactCamera& camera, double candidate_gap, std::vector<FacePair>& pairs);

 private:
  struct Crossing {
    std::uint32_t line;
    std::uint32_t face;  ///< index into `visible`
    double w;
    bool of_a;
    bool away;  ///< the triangle is turned away: a is left there, or b entered
  };
  struct Bins;
  struct Middles;
  template <class Lines>
  void cut(const Patch& patch, const ContactCamera& camera, bool of_a, const Lines& lines);
  template <class Lines>
  void cut_face(const Patch& patch, int face, std::uint32_t number, const ContactCamera& camera, bool of_a,
                const Lines& lines);
  void pair_crossings(double candidate_gap, std::vector<FacePair>& pairs);
  void pair_layers(std::size_t first, std::size_t last, double candidate_gap, std::vector<FacePair>& pairs);
  void fill_bins(std::span<const Eigen::Vector2d> points, const ContactCamera& camera);

  std::vector<Crossing> crossings_;
  std::vector<std::uint32_t> first_in_bin_, in_bins_;                      ///< points by pixel
  int first_column_ = 0, last_column_ = 0, first_row_ = 0, last_row_ = 0;  ///< where points are
};

}  // namespace palpate::contact
