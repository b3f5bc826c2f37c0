#pragma once
#include <vector>

#include "contact/contact_view.h"
#include "contact/facing.h"
#include "contact/image_side.h"
#include "contact/sample_cells.h"

namespace palpate::contact {

/// Sorts the samples of one region after another by what carries them.
class CellBuilder {
 public:
  /// @param area  of each sample [m^2]; negative: each says its own
  void start(const ContactAxes& axes, const ImageSide& a, const ImageSide& b, double area, SampleCells& out);
  /// The faces are those of the whole sides.
  void add(const Facing& at, int face_a, int face_b, double own_area = 0.0);
  void finish();  ///< the region's cells stand in `out`

 private:
  /// The carriers of one side in this region.
  struct Side {
    const ImageSide* surface = nullptr;
    std::vector<int> index;    ///< by the side's own numbers: into the carriers, -1: not met yet
    std::vector<int> numbers;  ///< those that were met
  };
  void start(Side& side, const ImageSide& surface);
  int carrier(Side& side, int face, const Vec3& weights, const Vec3& place);
  int carrier(Side& side, int number);
  int cell_of(int a, int b);
  int* slot(int a, int b);  ///< of the cell with these carriers, or where it belongs

  Side a_, b_;
  ContactAxes axes_;
  double area_ = 0.0;
  SampleCells* out_ = nullptr;
  std::size_t first_cell_ = 0;
  struct Pending {
    SamplePlace place;
    int cell;
    double area;
  };
  std::vector<Pending> pending_;
  std::vector<int> table_;  ///< cells of this region, by their carriers
};

}  // namespace palpate::contact
