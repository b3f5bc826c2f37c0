#include "work.h"

#include <optional>

#include "codec.h"
#include "core/bytes.h"
#include "palpate/loop/load.h"
#include "run.h"

namespace palpate::compare {

std::string encode_job(WorkKind kind, const scene::Description& description, double limit_s,
                       const Trajectory* reference) {
  ByteWriter out;
  out.put(kind).put(description.source).put(description.path).put(limit_s);
  out.put(reference ? bytes_of(*reference) : std::string());
  return out.take();
}

std::string run_job(const std::string& order, const std::atomic<bool>& out_of_time) {
  ByteReader in(order);
  const auto kind = in.get<WorkKind>();
  const auto source = in.get<std::string>(), path = in.get<std::string>();
  const auto limit_s = in.get<double>();
  const auto reference_bytes = in.get<std::string>();
  const scene::Description description = loop::parse(source, path);
  switch (kind) {
    case WorkKind::kReference:
      return bytes_of(run_once(description, description.compare.duration_s, &out_of_time));
    case WorkKind::kHaptic:
      return bytes_of(run_for_wrenches(description, description.compare.duration_s, &out_of_time));
    case WorkKind::kExchange: return bytes_of(compare_exchange(description, {{}, &out_of_time}));
    case WorkKind::kMethods: return bytes_of(compare_contact_methods(description, &out_of_time));
    case WorkKind::kPoint: break;
  }
  std::optional<Trajectory> reference;
  if (!reference_bytes.empty()) reference = trajectory_of(reference_bytes);
  return bytes_of(run_point(description, limit_s, reference ? &*reference : nullptr, &out_of_time));
}

}  // namespace palpate::compare
