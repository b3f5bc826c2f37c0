#pragma once
#include <vector>

#include "contact/depth_image.h"
#include "contact/face_kernels.h"
#include "contact/region_mesh.h"

namespace palpate::contact {

/// Some faces of a region on one side, which are drawn along one normal: all of them, or those of some
/// proxies. The others are never drawn, but where they are turned away from the camera a line leaves their
/// body.
class RegionPiece {
 public:
  void take(const RegionMesh& mesh);  ///< all of it.  @pre the mesh lives as long as it is looked at
  /// Of another piece what is of proxies that belong(proxy); the piece may be this one.
  template <class Belong>
  void take_part(const RegionPiece& whole, Belong belong) {
    mesh_ = whole.mesh_;
    own_.resize(whole.own_.size());
    for (std::size_t i = 0; i < own_.size(); ++i)
      own_[i] = whole.own_[i] != 0 && belong(mesh_->chunks()[i].proxy) ? 1 : 0;
  }

  // The faces of one image: see(), any number of cuts, finish().
  /// Its own faces whose normal has the sign `side` along the plane's, as far as they reach into `within`.
  /// @returns their bounds
  AxisBox see(const ContactAxes& axes, double side, const AxisBox& within);
  /// Removes the faces that do not reach into the window.
  /// @returns bounds of those that are left
  AxisBox cut(const AxisBox& window);
  /// Hands over the vertices, the faces that are left as `visible`, and those that are turned away, its own
  /// and the others', as far as they reach into `within`.
  void finish(const AxisBox& within, Patch& patch);

  PatchSource source(ImageSide& side) const { return {&side, mesh_->surface_faces()}; }
  /// In the whole surface, of one of the patch's faces.
  int face_of(int face) const { return mesh_->surface_faces()[static_cast<std::size_t>(face)]; }

 private:
  /// What is seen of a chunk.
  struct Seen {
    std::size_t first = 0, end = 0;  ///< in `visible_`
    AxisBox box;
  };
  template <class Keep>
  void keep_faces(Seen& seen, Keep keep);
  AxisBox bounds() const;

  const FaceKernels* kernels_ = &best_face_kernels();
  const RegionMesh* mesh_ = nullptr;
  std::vector<char> own_;  ///< by chunk

  // of the image under way
  ContactAxes axes_;
  double side_ = 1.0;
  std::vector<double> wide_;    ///< vertices in the axes, four numbers each
  Points uvw_;                  ///< the same in three
  std::vector<int> visible_;    ///< faces
  std::vector<Seen> seen_;      ///< by chunk that is seen, in their order
  std::vector<char> may_turn_;  ///< by chunk: whether some of its faces may be turned away
  std::vector<int> away_;       ///< faces
};

/// Both patches along the axes, and the window that fits their overlap, as contact_view.h has it.
ContactWindow fit_window(RegionPiece& of_a, RegionPiece& of_b, const ContactAxes& axes, double candidate_gap,
                         Patch& a, Patch& b);

}  // namespace palpate::contact
