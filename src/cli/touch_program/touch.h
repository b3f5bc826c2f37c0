#pragma once

namespace CLI {
class App;
}

namespace palpate::cli {

struct Invocation;

void add_touch(CLI::App& app, Invocation& invocation);

}  // namespace palpate::cli
