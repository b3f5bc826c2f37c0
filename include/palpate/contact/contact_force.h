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

/// Surface carried by nodes of the State. Its vertices are either nodes (vertex i is node
/// `node_of_vertex[i]`, counted within the block) or points of an embedded skin (vertex i is interpolated
/// from the nodes of the tetrahedron `tets.col(embedding.tet[i])` with four weights; docs/theory/proxies.md).
struct NodeSurface {
  int block_id = -1;                ///< Node block that carries the surface.
  std::vector<int> node_of_vertex;  ///< Node of each vertex; empty for a skin.
  Faces faces;                      ///< Vertex indices per face, oriented outwards.
  mesh::Embedding embedding{};      ///< Skin only: tetrahedron and weights per vertex.
  Tets tets{};                      ///< Skin only: the body's tetrahedra, nodes counted within the block.
};

/// Wall time of the queries of an image-space source by stage, accumulated since its construction [s].
struct QueryStages {
  /// Skin vertices from nodes, rigid surfaces from frames, as far as regions need them.
  double positions_s = 0.0;
  double regions_s = 0.0;      ///< Detection of the regions that may touch, and of their normals.
  double patches_s = 0.0;      ///< Faces of each region in contact axes, and its camera.
  double images_s = 0.0;       ///< Detection of opposite triangles. The following four are parts of it.
  double upload_s = 0.0;       ///< Surface data created for, or sent to, the GPU.
  double passes_s = 0.0;       ///< Rendering of both surfaces.
  double gather_s = 0.0;       ///< Comparison of both images, and compaction of the pairs into one list.
  double readback_s = 0.0;     ///< Remainder: commands, fence, and distribution of the list.
  double gaps_s = 0.0;         ///< Gaps in double precision, and samples.
  long images = 0, pairs = 0;  ///< Number of images, and of pairs of triangles in them.
  long pixels = 0;             ///< Pixels of all images.
  /// Vertices transformed to contact axes, of all images and both sides; faces visible in these images.
  long vertices = 0, faces = 0;
  long hits = 0;  ///< Samples.
};

/// Source of the contact samples of one pair, evaluated at the current state (the slow query).
class SampleSource {
 public:
  virtual ~SampleSource() = default;
  /// Returns the name of the method, as in `contact.method` of a scene, or of the obstacle's type.
  virtual std::string_view name() const = 0;
  /// Appends the samples of the pair at `state`, including candidates with a small positive gap.
  virtual void query(const dynamics::StateView& state, std::vector<ContactSample>& samples) = 0;
  /// Returns whether the samples are re-evaluated at each state between two queries, like nearest points.
  /// Samples at vertices are not: their gaps are linear in the positions.
  virtual bool follows() const { return false; }
  /// Evaluates the samples of the last query at another state, in the same order: exact gaps, normals, points
  /// and areas.
  virtual void follow(const dynamics::StateView&, std::span<ContactSample>) {}
  /// Returns the indices of the material points that the last query's samples represent, ascending; an index
  /// denotes the same point at every query. Empty where samples do not represent material points.
  virtual std::span<const int> material_points() const { return {}; }
  /// Adds the node pairs that the samples may couple: nodes of the faces of each surface, and across two soft
  /// bodies.
  virtual void add_pattern(dynamics::PatternBuilder& pattern) const = 0;
  /// Returns a counter that increases whenever add_pattern() would add other pairs.
  virtual std::uint64_t pattern_version() const { return 0; }
  /// Returns whether the force has a kink where a sample opens or closes, so that a root finder should stop
  /// there.
  virtual bool has_events() const { return true; }
  /// Returns the number of vertices that tunnelled: they passed through the shape or the other body between
  /// two queries and lay outside at both, so that no contact force acted on them.
  virtual long tunnelled() const { return 0; }
  /// Returns the time after the last query at which the next one is due [s]: at the velocities of the last
  /// query, no skin penetrates farther by then than half of the thickness of the body that it touches.
  virtual double safe_time() const { return HUGE_VAL; }
  /// Returns how often the safe time of a region was shorter than the time to the next query.
  virtual long fast_regions() const { return 0; }
  /// Returns the number of regions that kept the normal of the previous query, because they are so deep, or
  /// so much enclosed, that the skins do not determine the direction out.
  virtual long normals_kept() const { return 0; }
  /// Returns the counts of the pruning before the images, for a source with proxies; else null.
  virtual const proxy::PruneCounts* pruning() const { return nullptr; }
  /// Returns the quadrature error of the forces; null where the source does not estimate it.
  virtual const SumError* sum_error() const { return nullptr; }
  /// Returns the wall time by stage, for a source in image space; else null.
  virtual const QueryStages* stages() const { return nullptr; }
  /// Keeps the data that pictures need, from the next query on. By default nothing is kept.
  virtual void keep_view() {}
  /// Returns the picture data of the last query, for a source in image space that keeps it; else null.
  virtual const QueryView* view() const { return nullptr; }
  /// Saves or restores the state that the next query takes from earlier ones, and the counters.
  virtual void archive(Archive&) {}
};

/// Pressure p(gap, gap_rate) [Pa] and its derivatives. p >= 0 always (no adhesion), and p = 0 for gap >= 0.
/// With the depth delta = -gap > 0, its rate delta' = -gap_rate, and the onset function s(delta) =
/// delta^2/(2w) for delta < w and delta - w/2 beyond (s = delta for w = 0):
///   kelvin_voigt   p = max(0, k s + d s' delta')
///   hunt_crossley  p = max(0, k s (1 + 3/2 c delta'))      (Hunt and Crossley 1975)
/// With w > 0 the spring, and all of hunt_crossley, is C1 in depth and rate. The damper of kelvin_voigt then
/// sets in without a jump, but with a kink: its slope with respect to depth at first touch is d delta'/w.
/// Where the pressure is cut off during separation it is continuous, with a kink. `energy_density` is the
/// energy of the spring, k times the integral of s [J/m^2].
struct Pressure {
  /// p [Pa], its derivatives with respect to gap [Pa/m] and gap rate [Pa s/m], and the spring's energy
  /// density [J/m^2].
  double p, dp_dgap, dp_drate, energy_density;
};
/// Evaluates the pressure law. Resolves the names in `law` at each call. @throws Error for invalid parameters
/// @param law  stiffness, damping and onset  @param gap  [m], negative inside  @param gap_rate  [m/s]
Pressure pressure(const ContactSpec& law, double gap, double gap_rate);

/// Contact wrench on one frame and its derivatives, about the frame's origin, angular before linear.
struct FrameLinearisation {
  Wrench wrench;  ///< Wrench on the frame [N m, N].
  Mat6 K, B;      ///< -dF/dx and -dF/dv of the frame, bodies held fixed.
  /// Part of -K that is due to the rotation of the lever arms under the present forces (rotational rows and
  /// columns).
  Mat3 geometric;
  MatX K_body, B_body;    ///< nodal_size x 6: -df_nodes/dx_frame, -df_nodes/dv_frame.
  MatX K_frame, B_frame;  ///< 6 x nodal_size: -dF_frame/dx_nodes, -dF_frame/dv_nodes.
  int active = 0;         ///< Number of samples with pressure.
};

/// Magnitude of the resultant of a contact pair on one of its bodies, or of a change of it.
struct ResultantSize {
  double force = 0.0;   ///< Magnitude of the force [N].
  double moment = 0.0;  ///< Magnitude of the moment about the body's mean node or the frame's origin [N m].
};

/// Statistics of the grasps of all frames.
struct GraspCounts {
  long closed = 0;            ///< Number of grasps that began to hold something.
  long empty = 0;             ///< Number of grasp commands for which no sample was under pressure.
  int points = 0;             ///< Points held at present.
  double area = 0.0;          ///< Area held at present [m^2].
  double largest_area = 0.0;  ///< Largest area held at any time so far [m^2].
};

/// Connection of a node to a frame: a spring of zero length and a damper tie the node to a point of the
/// frame.
struct Tie {
  int node = 0;                           ///< Node, counted over all node blocks.
  Vec3 anchor = Vec3::Zero();             ///< Attachment point in the frame's axes [m].
  double stiffness = 0.0, damping = 0.0;  ///< Spring and damper constants [N/m, N s/m].
};

struct ReducedSample;  // reduced_contact_model.h
struct ReducedTangent;

/// Motion, within a step, of a frame that is not part of the State.
struct FrameStep {
  int frame = -1;              ///< Index returned by add_frame(); -1: no frame moves.
  Vec6 moved = Vec6::Zero();   ///< Rotation vector and displacement [rad, m].
  Vec6 change = Vec6::Zero();  ///< Change of the twist [rad/s, m/s].
};

/// Selects samples of a frame by the other side: nodes, another frame, or both.
enum class Partners { kAll, kNodes, kFrames };

/// All contacts of a scene as one force term (docs/theory/contact.md).
class ContactForce : public dynamics::ForceTerm,
                     public dynamics::PointStiffnessTerm,
                     public dynamics::RepeatedStepTerm {
 public:
  ContactForce();
  ~ContactForce() override;
  int add_frame(std::shared_ptr<MovingFrame> frame);  ///< Returns the index for SurfacePoint::frame.
  /// Adds one [[contact]]: the source of its samples and the law of their pressure. @return its index
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
  /// The following three functions concern pairs with friction_tangent = "secant": within a step their
  /// friction is evaluated at the end of the step (friction.h).
  bool has_onset_at(const dynamics::StateView& state) override;
  bool begin_step(const dynamics::StateView& state) override;
  bool improve_step(const dynamics::StateView& state, const VecX& moved, const VecX& change) override;
  /// Improves the friction guess for a pressing frame that moves and is not part of the State; all other
  /// friction keeps the value at the start of the step.
  /// @param state  start of the step  @param moved  displacement along u-directions [m, rad]
  /// @param change  change of u [m/s, rad/s]  @param given  motion of that frame
  /// @param tolerance  accepted relative difference of the friction from the law; 0: the default of a step
  ///   (friction.h)
  bool improve_step(const dynamics::StateView& state, const VecX& moved, const VecX& change,
                    const FrameStep& given, double tolerance = 0.0);
  void end_step() override;
  double energy(const dynamics::StateView& state) override;
  double dissipated_power(const dynamics::StateView& state) override;
  bool refresh(const dynamics::StateView& state) override;
  /// One root function for each sample whose pressure sets in with a kink (onset_width_m = 0): negative while
  /// the sample presses, positive while it does not, and zero exactly where it opens or closes. Because the
  /// damper is cut off during separation, that is not where the gap closes: see events() in
  /// contact_force.cpp. The number of functions is constant between two refreshes. A refresh may change it,
  /// even one that changes no force and returns false.
  int event_count() const override;
  std::uint64_t events_version() const override;
  void events(const dynamics::StateView& state, double* g) override;

  /// Closes or opens the grasp of a frame, effective at the next refresh. A closed grasp holds the points of
  /// nodes that press on the frame at that refresh, in addition to their contact: against separation and
  /// along the surface (src/contact/grasp.cpp). Points that come into contact later are not held. Opening
  /// releases all points.
  void set_grasp(int frame, bool closed);
  /// Returns the statistics of all grasps since the start.
  GraspCounts grasp_counts() const;
  /// Ties nodes to a frame permanently (src/contact/grasp.cpp).
  void tie(int frame, const std::vector<Tie>& ties);
  /// Returns the samples of the last query, candidates included.
  const std::vector<ContactSample>& samples() const;
  int sample_count() const;  ///< Returns the number of these samples.
  /// Returns the contact wrench on a frame, about its origin, in world axes [N m, N].
  Wrench frame_wrench(const dynamics::StateView& state, int frame) const;
  /// Linearises the contact of a frame at a state; `out` is resized.
  void linearise(const dynamics::StateView& state, int frame, FrameLinearisation& out,
                 Partners partners = Partners::kAll) const;
  /// Returns the samples of a frame on nodes at the given state, including candidates that are not in
  /// contact.
  /// @param state  state at which the gaps are evaluated  @param frame  index returned by add_frame()
  /// @param tangents  receives the tangent of each sample; null: not computed
  std::vector<ReducedSample> reduced_samples(const dynamics::StateView& state, int frame,
                                             std::vector<ReducedTangent>* tangents = nullptr) const;
  /// Returns the change of a pair's resultant on its bodies caused by the last refresh, at the state of that
  /// refresh; the largest of all pairs. It measures the error due to infrequent queries. The same resultant
  /// distributed to other nodes is no change.
  ResultantSize refresh_jump() const;
  /// Returns the largest refresh_jump() so far.
  ResultantSize largest_jump() const;
  /// Returns the largest resultant of one pair on one body after a refresh so far, as a reference for
  /// largest_jump().
  ResultantSize largest_resultant() const;
  /// Returns the largest friction force that a step neglected because the pressure changed and the friction
  /// did not, as the norm of a pair's sum [N]. Concerns the pairs with a symmetric tangent
  /// ("friction_tangent" symmetric or secant).
  double largest_friction_lag() const;
  /// Returns the largest friction force of these pairs, as the norm of a pair's sum [N].
  double largest_lagged_friction() const;
  /// Returns the number of tunnelled vertices per pair so far (SampleSource::tunnelled).
  std::vector<long> tunnelled() const;
  double safe_time() const;                ///< Returns the smallest safe time of the pairs [s].
  std::vector<long> fast_regions() const;  ///< Returns SampleSource::fast_regions() per pair.
  std::vector<long> normals_kept() const;  ///< Returns SampleSource::normals_kept() per pair.
  /// Returns the largest overlap along its normal that a query found, per pair [m]; 0: never touched.
  std::vector<double> deepest() const;
  /// Returns the pruning counts per pair; null for a pair without proxies.
  std::vector<const proxy::PruneCounts*> pruning() const;
  /// Returns the quadrature error per pair; null where its source does not estimate it.
  std::vector<const SumError*> sum_errors() const;
  /// Returns the wall time of the queries by stage, per pair; null for a pair without images.
  std::vector<const QueryStages*> stages() const;
  /// Returns the name of each pair's source ("distance", "plane").
  std::vector<std::string> methods() const;
  /// Makes every source keep the data that pictures need, from the next query on.
  void keep_views();
  /// Returns the picture data of the last query, per pair; null for a pair without images, and before
  /// keep_views().
  std::vector<const QueryView*> views() const;
  /// Returns all samples of the last query that have an area, candidates included, evaluated at the given
  /// state.
  std::vector<ContactPoint> points(const dynamics::StateView& state) const;
  /// Returns the number of refreshes so far, the first included.
  long queries() const;
  /// Returns the wall time spent in refreshes [s].
  double query_seconds() const;
  /// Saves or restores the state of a checkpoint: held points, data that queries take from earlier ones, and
  /// counters. Samples are not saved; they are recomputed by a query when the checkpoint is restored.
  /// @param a  archive that saves or restores  @param state  current state
  void archive(Archive& a, const dynamics::StateView& state);

 private:
  friend class SecantTangents;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Scope guard: during its lifetime all pairs use the tangents of friction_tangent = "secant", whatever their
/// setting: symmetric, as the tool's steps need them. These tangents do not count in largest_friction_lag().
class SecantTangents {
 public:
  /// @param contact  must outlive this object
  explicit SecantTangents(ContactForce& contact);
  ~SecantTangents();
  SecantTangents(const SecantTangents&) = delete;
  SecantTangents& operator=(const SecantTangents&) = delete;

 private:
  ContactForce::Impl& contact_;
};

}  // namespace palpate::contact
