#include "palpate/core/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>

namespace palpate::log {

void configure(bool quiet, bool verbose) {
  auto logger =
      std::make_shared<spdlog::logger>("palpate", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
  logger->set_pattern("palpate: %^%l%$: %v");
  logger->set_level(quiet ? spdlog::level::err : verbose ? spdlog::level::debug : spdlog::level::info);
  spdlog::set_default_logger(logger);
}

}  // namespace palpate::log
