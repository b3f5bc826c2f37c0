#include "session/missing_outputs.h"

#include <fmt/format.h>

#include <map>

namespace palpate::session {
namespace {

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

}  // namespace

void MissingOutputs::add(const std::string& what, const std::string& why) {
  outputs_.push_back(fmt::format("{} ({})", what, first_line(why)));
}

void MissingOutputs::add(const report::RunReport& report) {
  std::map<std::string, std::vector<std::string>> captions;  // by reason, which captions often share
  for (const auto& figure : report.missing_figures)
    captions[first_line(figure.why)].push_back(first_line(figure.caption));
  for (const auto& [why, figures] : captions)
    add(figures.size() == 1 ? fmt::format("figure \"{}\" in {}", figures[0], report.page.string())
                            : fmt::format("{} figures in {}", figures.size(), report.page.string()),
        why);
}

void MissingOutputs::add(const MissingOutputs& more) {
  outputs_.insert(outputs_.end(), more.outputs_.begin(), more.outputs_.end());
}

}  // namespace palpate::session
