#pragma once
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "palpate/contact/frame.h"
#include "palpate/contact/query_view.h"
#include "palpate/contact/sample.h"
#include "palpate/contact/spec.h"
#include "palpate/contact/sum_error.h"
#include "palpate/core/archive.h"
#include "palpate/dynamics/force_term.h"
#include "palpate/dynamics/repeated_step.h"
#include "palpate/dynamics/step_assembly.h"
#include "palpate/mesh/embedding.h"

namespace palpate::proxy {
struct PruneCounts;
}  // namespace palpate::proxy

namespace palpate::contact {

/// A surface that nodes of the State carry.  Its vertices are nodes themselves: vertex i is node
/// `node_of_vertex[i]` counted inside the block; or points of a skin: vertex i hangs on the tetrahedron
/// `tets.col(embedding.tet[i])` by four weights (docs/design.md 4.2).
struct NodeSurface {
  int block_id = -1;                ///< the node block that carries it
  std::vector<int> node_of_vertex;  ///< empty of a skin
  Faces faces;                      ///< vertex indices, outward
  mesh::Embedding embedding{};      ///< of a skin
  Tets tets{};                      ///< of a skin: the body's tetrahedra, nodes counted inside the block
};

/// Wall time of the queries of a source in image space, by stage, since it was made [s].
struct QueryStages {
  double positions_s = 0.0;    ///< skins from nodes, rigid surfaces from frames, as far as regions need them
  double regions_s = 0.0;      ///< which skin may touch, and along which normal
  double patches_s = 0.0;      ///< faces of a region in its axes, and its camera
  double images_s = 0.0;       ///< which triangles face each other; of that:
  double upload_s = 0.0;       ///< what was made, or sent, of the surfaces for the GPU
  double passes_s = 0.0;       ///< both surfaces drawn
  double gather_s = 0.0;       ///< both compared, and the pairs brought into one list
  double readback_s = 0.0;     ///< all else of the images: commands, fence, and the list handed out
  double gaps_s = 0.0;         ///< gaps in double, and samples
  long images = 0, pairs = 0;  ///< images taken, and pairs of triangles in them
  long pixels = 0;             ///< of all images
  long vertices = 0, faces = 0;  ///< in axes of all images, of both sides; faces that these images show
  long hits = 0;                 ///< samples
};

/// Makes the samples of one pair from the current state: the slow query.
class SampleSource {
 public:
  virtual ~SampleSource() = default;
  /// As `contact.method` of a scene calls it, or the obstacle's type.
  virtual std::string_view name() const = 0;
  /// Appends samples; candidates with a small positive gap included.
  virtual void query(const dynamics::StateView& state, std::vector<ContactSample>& samples) = 0;
  /// Whether the samples follow the state between two queries, as nearest points do.  Those at vertices do
  /// not: there their gaps are linear in the positions.
  virtual bool follows() const { return false; }
  /// The samples of the last query at another state, in their order: exact gaps, normals, points and areas.
  virtual void follow(const dynamics::StateView&, std::span<ContactSample>) {}
  /// Numbers of the material points that the last query's samples stand for, ascending, the same at
  /// every query; empty where a sample stands for no such point.
  virtual std::span<const int> material_points() const { return {}; }
  /// Node pairs its samples may couple (faces of each surface; of two soft bodies also across).
  virtual void add_pattern(dynamics::PatternBuilder& pattern) const = 0;
  /// Grows whenever add_pattern() would add other pairs.
  virtual std::uint64_t pattern_version() const { return 0; }
  /// Whether a sample's opening and closing is a kink of the force that a root finder should stop at.
  virtual bool has_events() const { return true; }
  /// Vertices that went through the shape or the other body between two queries, outside it at both: nothing
  /// has pushed them back.
  virtual long tunnelled() const { return 0; }
  /// How long after the last query, at the velocities that it saw, the next is due, so that until then no
  /// skin goes farther into what it touches than half of its thickness [s].
  virtual double safe_time() const { return HUGE_VAL; }
  /// How often a region was so fast that this is less than the time to the next query.
  virtual long fast_regions() const { return 0; }
  /// Regions so deep, or so much enclosed, that no skin says which way is out: they kept the normal of the
  /// query before.
  virtual long normals_kept() const { return 0; }
  /// What was left out before the image, of a source that has proxies; else null.
  virtual const proxy::PruneCounts* pruning() const { return nullptr; }
  /// Quadrature error of its forces; null of a source that has no estimate.
  virtual const SumError* sum_error() const { return nullptr; }
  /// Of a source in image space; else null.
  virtual const QueryStages* stages() const { return nullptr; }
  /// From the next query on, keep what pictures show of it; nothing is kept, or paid for, before.
  virtual void keep_view() {}
  /// Of the last query, of a source in image space that keeps it; else null.
  virtual const QueryView* view() const { return nullptr; }
  /// What the next query takes from those before, and what was counted so far.
  virtual void archive(Archive&) {}
};

/// Pressure p(gap, gap_rate) [Pa] and its derivatives; p >= 0 always (never adhesive), zero for gap >= 0.
/// With the depth delta = -gap > 0, its rate delta' = -gap_rate, and the onset s(delta) = delta^2/(2w) up to
/// the width w, delta - w/2 beyond (delta for w = 0):
///   kelvin_voigt   p = max(0, k s + d s' delta')
///   hunt_crossley  p = max(0, k s (1 + 3/2 c delta'))      (Hunt and Crossley 1975)
/// With w > 0 the spring, and all of hunt_crossley, is C1 in depth and rate; the damper of kelvin_voigt sets
/// in without its jump, but with a kink (its slope by depth there is d delta'/w).  Where the pressure is cut
/// off in parting it stays continuous, with a kink. `energy_density` is that of the spring, k times the
/// integral of s [J/m^2].
struct Pressure {
  double p, dp_dgap, dp_drate, energy_density;  ///< p [Pa], its derivatives by gap [Pa/m] and by gap rate [Pa
                                                ///< s/m], and that of the spring
};
/// @param law  stiffness, damping and onset  @param gap  [m], negative inside  @param gap_rate  [m/s]
Pressure pressure(const ContactSpec& law, double gap, double gap_rate);

/// Derivatives of the contact seen from one frame, about its origin, angular first.
struct FrameLinearisation {
  Wrench wrench;  ///< on the frame
  Mat6 K, B;      ///< -dF/dx, -dF/dv of the frame, bodies held
  /// the part of -K that is the rotating arms' under the forces as they are (rows and columns of rotation)
  Mat3 geometric;
  MatX K_body, B_body;    ///< nodal_size x 6: -df_nodes/dx_frame, -df_nodes/dv_frame
  MatX K_frame, B_frame;  ///< 6 x nodal_size: -dF_frame/dx_nodes, -dF_frame/dv_nodes
  int active = 0;         ///< samples with pressure
};

/// How large the resultant of a contact pair on one of its bodies is, or a change of it.
struct ResultantSize {
  double force = 0.0;   ///< [N]
  double moment = 0.0;  ///< about the body's mean node or the frame's origin [N m]
};

/// Grasps of all frames.
struct GraspCounts {
  long closed = 0;            ///< times that one began to hold something
  long empty = 0;             ///< times that nothing pressed where one was to begin
  int points = 0;             ///< held now
  double area = 0.0;          ///< held now [m^2]
  double largest_area = 0.0;  ///< held at once so far [m^2]
};

/// A node that a frame carries: a spring of zero length and a damper tie it to its place in the frame.
struct Tie {
  int node = 0;                           ///< counted over all node blocks
  Vec3 anchor = Vec3::Zero();             ///< where it is tied, in the frame's axes [m]
  double stiffness = 0.0, damping = 0.0;  ///< [N/m, N s/m]
};

struct TouchSample;  // touch_model.h
struct TouchTangent;

/// How a frame that the state does not have moves within a step.
struct FrameStep {
  int frame = -1;              ///< as add_frame() counts; -1: none moves
  Vec6 moved = Vec6::Zero();   ///< rotation vector, displacement [rad, m]
  Vec6 change = Vec6::Zero();  ///< of the twist [rad/s, m/s]
};

/// Which samples of a frame: those with nodes on the other side, those with another frame there.
enum class Partners { kAll, kNodes, kFrames };

/// All contacts of a scene as one force term (docs/design.md 4.4).
class ContactForce : public dynamics::ForceTerm,
                     public dynamics::PointStiffnessTerm,
                     public dynamics::RepeatedStepTerm {
 public:
  ContactForce();
  ~ContactForce() override;
  int add_frame(std::shared_ptr<MovingFrame> frame);  ///< index for SurfacePoint::frame
  /// One [[contact]]: where its samples come from, and the law of their pressure.  @return its number
  int add_pair(std::unique_ptr<SampleSource> source, const ContactSpec& law);

  std::string_view name() const override;
  dynamics::TermTraits traits() const override;
  void add_pattern(dynamics::PatternBuilder& pattern) const override;
  std::uint64_t pattern_version() const override;
  void add_force(const dynamics::StateView& state, VecX& f) override;
  void add_tangent(const dynamics::StateView& state, double k_scale, double d_scale,
                   dynamics::BorderedMatrix& A) override;
  void apply_tangent(const dynamics::StateView& state, double k_scale, double d_scale, const VecX& x,
                     VecX& y) override;
  bool is_point_stiffness() const override;
  void add_step(const dynamics::StateView& state, const VecX& shift, double k_scale, double d_scale, VecX& f,
                dynamics::PointStiffness& C) override;
  void add_step_force(const dynamics::StateView& state, const VecX& shift, const VecX& change,
                      VecX& f) override;
  /// Of pairs with friction_tangent = "secant": within a step their friction is that of its end (friction.h).
  bool bends_at(const dynamics::StateView& state) override;
  bool begin_step(const dynamics::StateView& state) override;
  bool improve_step(const dynamics::StateView& state, const VecX& moved, const VecX& change) override;
  /// Improves friction where a frame presses that moves and that the state does not have; all other friction
  /// stays that of the step's start.
  /// @param state  where the step begins  @param moved  along u-directions [m, rad]
  /// @param change  of u [m/s, rad/s]  @param given  how that frame moves
  /// @param tolerance  of friction's difference from the law's, relative; 0: a step's own (friction.h)
  bool improve_step(const dynamics::StateView& state, const VecX& moved, const VecX& change,
                    const FrameStep& given, double tolerance = 0.0);
  void end_step() override;
  double energy(const dynamics::StateView& state) override;
  double dissipated_power(const dynamics::StateView& state) override;
  bool refresh(const dynamics::StateView& state) override;
  /// One root function for each sample that sets in with a kink (onset_width_m = 0): negative while it
  /// presses, positive while it does not, zero exactly where it opens or closes.  With the damper cut off in
  /// parting that is not where the gap closes: see events in contact_force.cpp.
  /// Their number is constant between two refreshes, and a refresh may change it, also one that changes no
  /// force and returns false.
  int event_count() const override;
  std::uint64_t events_version() const override;
  void events(const dynamics::StateView& state, double* g) override;

  /// From the next refresh on a frame holds the points of nodes that press on it then, beside their contact:
  /// against being pulled off and along the surface (src/contact/grasp.cpp); or lets all go.  What comes to
  /// press later is not held.
  void set_grasp(int frame, bool closed);
  /// Since the start.
  GraspCounts grasp_counts() const;
  /// Ties nodes to a frame, for good (src/contact/grasp.cpp).
  void tie(int frame, const std::vector<Tie>& ties);
  /// Of the last query, candidates included.
  const std::vector<ContactSample>& samples() const;
  int sample_count() const;  ///< of these
  /// On a frame, about its origin, world axes [N m, N].
  Wrench frame_wrench(const dynamics::StateView& state, int frame) const;
  /// Contact of a frame at a state, with its derivatives; `out` is resized.
  void linearise(const dynamics::StateView& state, int frame, FrameLinearisation& out,
                 Partners partners = Partners::kAll) const;
  /// The samples of a frame on nodes, at the state given; candidates that are apart included.
  /// @param state  where the gaps are taken  @param frame  as add_frame() counts
  /// @param tangents  of each, where it is wanted
  std::vector<TouchSample> touch_samples(const dynamics::StateView& state, int frame,
                                         std::vector<TouchTangent>* tangents = nullptr) const;
  /// Change of a pair's resultant on its bodies that the last refresh made, at its state, the largest of all
  /// pairs: the price of a slow query.  The same resultant on other nodes is no change.
  ResultantSize refresh_jump() const;
  /// The largest of them so far, and the largest resultants after a refresh, to judge them by.
  ResultantSize largest_jump() const;
  /// On one body, of one pair.
  ResultantSize largest_resultant() const;
  /// Of the pairs whose tangent is symmetric ("friction_tangent" symmetric or secant): the largest friction
  /// that a step left out, for the pressure changed and the friction did not, and the largest friction, both
  /// as the norm of a pair's sum [N].
  double largest_friction_lag() const;
  /// See largest_friction_lag().
  double largest_lagged_friction() const;
  /// Vertices of each pair, in their order, that went through unseen so far (SampleSource::tunnelled).
  std::vector<long> tunnelled() const;
  double safe_time() const;                ///< the least of the pairs' [s]
  std::vector<long> fast_regions() const;  ///< of each pair
  std::vector<long> normals_kept() const;  ///< of each pair
  /// The largest overlap that a query saw, along its normal, of each pair; 0: they never touched [m].
  std::vector<double> deepest() const;
  /// What the proxies of each pair left out, in the pairs' order; null for a pair without proxies.
  std::vector<const proxy::PruneCounts*> pruning() const;
  /// Quadrature error of each pair; null where its source does not estimate it.
  std::vector<const SumError*> sum_errors() const;
  /// Where the time of each pair's queries went; null for a pair without an image.
  std::vector<const QueryStages*> stages() const;
  /// The name of each pair's source ("distance", "plane").
  std::vector<std::string> methods() const;
  /// Asks every source to keep what pictures show of its queries, from the next one on.
  void keep_views();
  /// What each pair's last query saw; null for a pair without an image, and where nobody asked.
  std::vector<const QueryView*> views() const;
  /// Returns all samples of the last query that have an area, candidates included, at the state given.
  std::vector<ContactPoint> points(const dynamics::StateView& state) const;
  /// Refreshes so far, the first included.
  long queries() const;
  /// Wall time in them [s].
  double query_seconds() const;
  /// What a checkpoint keeps: what frames hold, what queries know of those before, what was counted.  The
  /// samples are none of it: where it is given back, they are made anew by a query at that state.
  /// @param a  which keeps, or gives back  @param state  as it is now
  void archive(Archive& a, const dynamics::StateView& state);

 private:
  friend class SecantTangents;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// While it lives, tangents are those of friction_tangent = "secant" for all pairs, whatever they have:
/// symmetric, and those of a tick.  What a step leaves out (largest_friction_lag) does not count them.
class SecantTangents {
 public:
  /// @param contact  outlives this
  explicit SecantTangents(ContactForce& contact);
  ~SecantTangents();
  SecantTangents(const SecantTangents&) = delete;
  SecantTangents& operator=(const SecantTangents&) = delete;

 private:
  ContactForce::Impl& contact_;
};

}  // namespace palpate::contact
