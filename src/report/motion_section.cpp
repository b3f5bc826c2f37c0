#include <cmath>

#include "core/time_text.h"
#include "palpate/core/error.h"
#include "palpate/store/run_file.h"
#include "sections.h"
#include "surface_json.h"

namespace palpate::report {

void add_motion(Page& page, const std::filesystem::path& vtkhdf, double shown_at_s) {
  try {
    const std::string json = surface_json(store::RunReader(vtkhdf.string()), {}, shown_at_s);
    if (!json.empty())
      page.add_view(
          json,
          fmt::format("The run as it was recorded{}: drag to turn; after a click the wheel zooms, as + "
                      "and - do. A tool is grey.",
                      std::isfinite(shown_at_s)
                          ? fmt::format(", beginning with the state that follows the largest force on the "
                                        "hand (at {} s)",
                                        time_text(shown_at_s))
                          : ""));
  } catch (const Error& e) { page.add_missing_figure("the bodies over time", e.what()); }
}

}  // namespace palpate::report
