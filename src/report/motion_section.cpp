#include <cmath>

#include "core/time_text.h"
#include "palpate/core/error.h"
#include "palpate/store/run_reader.h"
#include "sections.h"
#include "surface_json.h"

namespace palpate::report {

void add_motion(Page& page, const std::filesystem::path& vtkhdf, double shown_at_s) {
  try {
    const std::string json = surface_json(store::RunReader(vtkhdf.string()), {}, shown_at_s);
    if (!json.empty())
      page.add_view(
          json,
          fmt::format("Recorded motion{}: drag to rotate; after a click, the wheel or the keys + and - zoom. "
                      "Tools are grey.",
                      std::isfinite(shown_at_s)
                          ? fmt::format(", starting at the first state after the peak force on the hand (at "
                                        "{} s)",
                                        time_text(shown_at_s))
                          : ""));
  } catch (const Error& e) { page.add_missing_figure("motion of the bodies", e.what()); }
}

}  // namespace palpate::report
