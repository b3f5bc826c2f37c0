#include "loop/trace.h"

#include "palpate/core/error.h"

namespace palpate::loop {

NamedDirection name_of(const dynamics::Layout& layout, int dof) {
  static const char* const kAxes[] = {"x", "y", "z"};
  for (const dynamics::Block& block : layout.blocks) {
    const int i = dof - block.u_offset;
    if (i < 0 || i >= block.u_size) continue;
    if (block.kind == dynamics::BlockKind::kNodes) return {block.name, i / 3, kAxes[i % 3]};
    if (block.kind == dynamics::BlockKind::kRigidBody)
      return {block.name, -1, std::string(i < 3 ? "rotation " : "") + kAxes[i % 3]};
    return {block.name, -1, fmt::format("coordinate {}", i)};
  }
  return {};
}

const std::vector<std::string>& TraceRecorder::columns() {
  static const std::vector<std::string> names = {
      "time_s",     "step_s",     "order",      "error",         "newton_iterations", "outcome",
      "worst_body", "worst_node", "worst_axis", "inverted_body", "inverted_element",  "halvings"};
  return names;
}

TraceRecorder::TraceRecorder(World& world, const std::string& path) : world_(world), csv_(path, columns()) {
  if (!world_.stepper)
    fail("scene \"{}\": --trace records the steps of bodies, but this scene has no body",
         world_.description.name);
  world_.stepper->set_trace(this);
}

TraceRecorder::~TraceRecorder() { world_.stepper->set_trace(nullptr); }

void TraceRecorder::attempt(const dynamics::StepAttempt& a) {
  ++attempts_;
  rejected_ += a.outcome != dynamics::StepAttempt::Outcome::kAccepted &&
               a.outcome != dynamics::StepAttempt::Outcome::kEvent;
  NamedDirection worst = name_of(world_.state.layout(), a.worst_dof);
  if (const Body* body = world_.find_body(worst.block); body && worst.node >= 0)
    worst.node = body->file_node[static_cast<std::size_t>(worst.node)];
  const auto number_or_none = [](int n) {
    return n < 0 ? store::CsvCell(std::string()) : store::CsvCell(static_cast<double>(n));
  };
  csv_.row(std::vector<store::CsvCell>{
      a.t, a.h, static_cast<double>(a.order), a.error, static_cast<double>(a.newton_iterations),
      std::string(to_string(a.outcome)), worst.block, number_or_none(worst.node), worst.axis,
      a.inverted_element < 0 ? std::string() : a.inverted_in, number_or_none(a.inverted_element),
      static_cast<double>(a.halvings)});
}

void TraceRecorder::close() { csv_.close(); }

}  // namespace palpate::loop
