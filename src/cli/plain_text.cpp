#include "plain_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <sstream>
#include <vector>

#include "report/table.h"

namespace palpate::cli {
namespace {

std::size_t columns(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

/// Returns the text of a link, with its target if a terminal can follow it.
std::string shown_link(const std::string& words, const std::string& target) {
  static const std::regex page(R"(([a-z0-9-]+)\.md(#.*)?)");
  std::smatch match;
  if (target.starts_with("#")) return words;
  if (!std::regex_match(target, match, page))
    return words == target ? words : fmt::format("{} ({})", words, target);
  const std::string command = fmt::format("`palpate help {}`", match[1].str());
  return words.ends_with(".md") ? command : fmt::format("{} ({})", words, command);
}

/// Replaces links, images and bold in one line of text; text in backticks is unchanged.
std::string inline_text(const std::string& text) {
  static const std::regex token(R"((!?)\[((?:`[^`]*`|[^\[\]`])*)\]\(([^()\s]+)\)|`[^`]*`|\*\*)");
  std::string out;
  auto rest = text.cbegin();
  for (std::sregex_iterator it(text.begin(), text.end(), token), end; it != end; ++it) {
    const std::smatch& match = *it;
    out.append(rest, match[0].first);
    rest = match[0].second;
    if (match.str().starts_with("`"))
      out += match.str();
    else if (match[3].matched)
      out += match[1].length() > 0 ? fmt::format("[picture: {}]", match[2].str())
                                   : shown_link(match[2].str(), match[3].str());
  }
  return out.append(rest, text.cend());
}

/// Returns the words filled to the width: the first line begins with `first`, all others with `hanging`
/// blanks.
std::string filled(const std::string& text, std::size_t width, const std::string& first,
                   std::size_t hanging) {
  std::istringstream words(text);
  std::string out, line = first;
  bool empty = true;
  for (std::string word; words >> word;) {
    if (!empty && columns(line) + 1 + columns(word) > width) {
      out += line + "\n";
      line.assign(hanging, ' ');
      empty = true;
    }
    if (!empty) line += ' ';
    line += word;
    empty = false;
  }
  return out + line + "\n";
}

/// Returns the cells of `| a | b |`; `\|` is a literal stroke.
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::string cell;
  for (std::size_t i = 1; i < line.size(); ++i) {
    if (line[i] == '\\' && i + 1 < line.size() && line[i + 1] == '|') {
      cell += line[++i];
    } else if (line[i] == '|') {
      const auto begin = cell.find_first_not_of(' '), end = cell.find_last_not_of(' ');
      cells.push_back(begin == std::string::npos ? "" : inline_text(cell.substr(begin, end - begin + 1)));
      cell.clear();
    } else {
      cell += line[i];
    }
  }
  return cells;
}

std::string shown_table(const std::vector<std::string>& lines, std::size_t width) {
  std::vector<std::string> headers = cells_of(lines[0]);
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 2; i < lines.size(); ++i) {
    rows.push_back(cells_of(lines[i]));
    rows.back().resize(headers.size());
  }
  const std::string aligned = report::format_table(headers, rows);
  std::istringstream in(aligned);
  std::size_t widest = 0;
  for (std::string line; std::getline(in, line);) widest = std::max(widest, columns(line));
  if (widest <= width) return aligned;
  std::string out;
  for (const std::vector<std::string>& row : rows) {
    out += filled(row[0], width, "", 0);
    for (std::size_t i = 1; i < row.size(); ++i)
      if (!row[i].empty())
        out += filled((headers[i].empty() ? "" : headers[i] + ": ") + row[i], width, "    ", 6);
  }
  return out;
}

/// Formats a page, block by block.
class Renderer {
 public:
  explicit Renderer(std::size_t width) : width_(width) {}

  void line(const std::string& text) {
    if (in_comment_ || text.starts_with("<!--")) {
      in_comment_ = text.find("-->") == std::string::npos;
    } else if (text.starts_with("```")) {
      flush();
      if (in_code_) out_ += "\n";
      in_code_ = !in_code_;
    } else if (in_code_) {
      out_ += text.empty() ? "\n" : "    " + text + "\n";
    } else if (text.starts_with("|")) {
      if (!words_.empty()) flush();
      table_.push_back(text);
    } else if (text.find_first_not_of(' ') == std::string::npos) {
      flush();
    } else if (text.starts_with("#")) {
      flush();
      heading(text);
    } else {
      words(text);
    }
  }

  std::string finish() {
    flush();
    while (out_.ends_with("\n\n")) out_.pop_back();
    return out_;
  }

 private:
  void heading(const std::string& text) {
    const std::size_t level = text.find_first_not_of('#');
    if (level == std::string::npos || text[level] != ' ') return words(text);
    const std::string shown = inline_text(text.substr(level + 1));
    out_ += shown + "\n";
    if (level <= 2) out_ += std::string(columns(shown), level == 1 ? '=' : '-') + "\n";
    out_ += "\n";
  }

  void words(const std::string& text) {
    static const std::regex item(R"(^([-*]|\d+\.) +(.*))");
    std::smatch match;
    if (std::regex_match(text, match, item)) {
      end_paragraph();
      bullet_ = match[1].str() + " ";
      words_ = match[2].str();
      return;
    }
    if (!table_.empty()) flush();
    words_ += (words_.empty() ? "" : " ") + text;
  }

  void end_paragraph() {
    if (words_.empty()) return;
    out_ += filled(inline_text(words_), width_, bullet_, bullet_.size());
    words_.clear();
    bullet_.clear();
  }

  void flush() {
    const bool something = !words_.empty() || !table_.empty();
    end_paragraph();
    if (!table_.empty()) out_ += shown_table(table_, width_);
    table_.clear();
    if (something && !out_.ends_with("\n\n")) out_ += "\n";
  }

  std::size_t width_;
  std::string out_, words_, bullet_;
  std::vector<std::string> table_;
  bool in_code_ = false, in_comment_ = false;
};

}  // namespace

std::string plain_text(const std::string& markdown, std::size_t width) {
  Renderer renderer(width);
  std::istringstream in(markdown);
  for (std::string line; std::getline(in, line);) renderer.line(line);
  return renderer.finish();
}

std::string title_of(const std::string& markdown) {
  std::istringstream in(markdown);
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("# ")) return inline_text(line.substr(2));
  return "";
}

}  // namespace palpate::cli
