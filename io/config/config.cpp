#include "io/config/config.h"

#include <yaml-cpp/depthguard.h>
#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>
#include <unordered_map>
#include <variant>

#include "base/file_watch.h"
#include "base/plain_text.h"
#include "base/suggest.h"
#include "base/units.h"

namespace axisfit {
namespace {

constexpr std::size_t kMaxBytes = 1 << 20;
constexpr int kMaxDepth = 32;
constexpr int kMaxNodes = 100'000;
constexpr std::string_view kMergeKey = "<<";

bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool is_control(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte < 0x20 || byte == 0x7F;
}

// Whether a byte of UTF-8 text continues a character.
bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

std::string joined(std::span<const std::string> texts) {
  std::string result;
  for (const std::string& text : texts) {
    if (!result.empty()) result += ", ";
    result += text;
  }
  return result;
}

// "; did you mean 'x'?" or nothing
std::string suggestion(std::string_view text, std::span<const std::string> candidates) {
  const std::string best = closest_match(text, candidates);
  return best.empty() ? std::string() : "; did you mean '" + best + "'?";
}

std::string_view trimmed(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

// Reads the decimal number at the start of `text` and returns what follows it. Nothing when there
// is none or when it may be meant otherwise: 010 is octal in YAML 1.1, 0,5 and 1_000 are numbers
// elsewhere.
template <typename T>
std::optional<std::string_view> read_number(std::string_view text, T& number) {
  // std::from_chars takes no plus sign, but would take the "-5" of "+-5".
  const bool has_plus = text.starts_with('+');
  if (has_plus) text.remove_prefix(1);
  std::string_view digits = text;
  if (!has_plus && digits.starts_with('-')) digits.remove_prefix(1);
  const bool is_number = !digits.empty() && (is_digit(digits[0]) || digits[0] == '.');
  if (!is_number) return std::nullopt;  // std::from_chars would take "nan" and "inf"
  if (digits.size() > 1 && digits[0] == '0' && is_digit(digits[1])) return std::nullopt;

  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (status != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  if (!text.empty() && std::string_view(".,_'").find(text.front()) != std::string_view::npos) {
    return std::nullopt;
  }
  return text;
}

std::string to_text(double value) {
  char buffer[32];
  const auto result = std::to_chars(std::begin(buffer), std::end(buffer), value);
  return std::string(std::begin(buffer), result.ptr);
}

std::string too_deep() { return "nested more than " + std::to_string(kMaxDepth) + " levels deep"; }

// "lie between 1 kg and 5 kg"; `unit` is empty or starts with a space. Not for a range without any
// limit.
std::string range_text(double lower, double upper, const std::string& unit) {
  if (!std::isfinite(upper)) return "be at least " + to_text(lower) + unit;
  if (!std::isfinite(lower)) return "be at most " + to_text(upper) + unit;
  return "lie between " + to_text(lower) + unit + " and " + to_text(upper) + unit;
}

// A limit written in another unit must count as within the limits although its conversion rounds.
double snapped(double value, double limit) {
  constexpr double kRounding = 1e-14;
  if (!std::isfinite(limit)) return value;
  return std::abs(value - limit) <= kRounding * std::abs(limit) ? limit : value;
}

// Where the documents of a YAML text begin, and what is in them.
class DocumentStarts : public YAML::EventHandler {
 public:
  struct Start {
    YAML::Mark document, content;
  };
  const std::vector<Start>& starts() const { return starts_; }

  void OnDocumentStart(const YAML::Mark& mark) override {
    starts_.push_back({mark, mark});
    empty_ = true;
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { content(mark); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { content(mark); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                const std::string&) override {
    content(mark);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    content(mark);
  }
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    content(mark);
  }
  void OnMapEnd() override {}

 private:
  void content(const YAML::Mark& mark) {
    if (std::exchange(empty_, false)) starts_.back().content = mark;
  }

  std::vector<Start> starts_;
  bool empty_ = true;
};

}  // namespace

// A file that was read.
struct ConfigNode::Source {
  std::string path;
  std::string contents;
  Diagnostics* diagnostics;

  void error(const YAML::Mark& mark, std::string message) const {
    // Finding the place takes time in a large file.
    if (diagnostics->full()) return diagnostics->add({});
    // yaml-cpp counts from 0, and columns in bytes.
    const std::size_t position =
        std::min(mark.pos < 0 ? 0 : static_cast<std::size_t>(mark.pos), contents.size());
    const std::string_view before = std::string_view(contents).substr(0, position);
    const std::string_view line = before.substr(before.rfind('\n') + 1);
    const auto column =
        line.size() - static_cast<std::size_t>(std::ranges::count_if(line, is_continuation));
    diagnostics->add({path, static_cast<int>(1 + std::ranges::count(before, '\n')),
                      static_cast<int>(1 + column), std::move(message)});
  }
};

// Looks through a document for what yaml-cpp accepts in silence.
class ConfigCheck {
 public:
  explicit ConfigCheck(const ConfigNode::Source& source) : source_(source) {}

  // False when the document is too large or too deep to be read any further.
  bool run(const YAML::Node& node, int depth = 1) {
    if (depth > kMaxDepth && !node.IsScalar() && !node.IsNull()) {
      source_.error(node.Mark(), too_deep());
      return false;
    }
    if (++nodes_ > kMaxNodes) {
      source_.error(node.Mark(),
                    "more than " + std::to_string(kMaxNodes) + " values, with aliases expanded");
      return false;
    }
    // "?" is a plain and "!" a quoted node without a tag.
    if (const std::string& tag = node.Tag(); !tag.empty() && tag != "?" && tag != "!") {
      source_.error(node.Mark(), "tags are not supported: " + in_quotes(tag));
    }
    if (node.IsSequence()) {
      return std::all_of(node.begin(), node.end(),
                         [&](const YAML::Node& entry) { return run(entry, depth + 1); });
    }
    return !node.IsMap() || run_map(node, depth);
  }

 private:
  bool run_map(const YAML::Node& map, int depth) {
    std::unordered_map<std::string, int> first_line;
    for (const auto& entry : map) {
      check_key(entry.first, first_line);
      if (!run(entry.first, depth + 1) || !run(entry.second, depth + 1)) return false;
    }
    return true;
  }

  void check_key(const YAML::Node& key, std::unordered_map<std::string, int>& first_line) const {
    if (!key.IsScalar()) {
      source_.error(key.Mark(), "a key must be text");
      return;
    }
    const std::string& text = key.Scalar();
    if (text == kMergeKey) {
      source_.error(key.Mark(), "merge keys ('<<') are not supported; write the entries out");
      return;
    }
    const auto [first, is_new] = first_line.try_emplace(text, key.Mark().line + 1);
    if (!is_new) {
      source_.error(key.Mark(), "duplicate key " + in_quotes(text) + ", first given on line " +
                                    std::to_string(first->second));
    }
  }

  const ConfigNode::Source& source_;
  int nodes_ = 0;
};

std::optional<ConfigNode> ConfigNode::load(const std::string& path, Diagnostics& diagnostics) {
  const auto failure = [&](const std::string& message) {
    diagnostics.add({path, 1, 1, message});
    return std::nullopt;
  };
  std::error_code status;
  if (std::filesystem::exists(path, status) && !std::filesystem::is_regular_file(path, status)) {
    return failure("not a file");  // reading a pipe or a device could block
  }
  const FileWatch watch(path);
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return failure(std::string("cannot be opened: ") + std::strerror(errno));

  std::string contents;
  for (std::array<char, 4096> part; contents.size() <= kMaxBytes && stream;) {
    stream.read(part.data(), part.size());
    contents.append(part.data(), static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad()) return failure("cannot be read");
  if (watch.has_changed()) return failure(FileWatch::kMessage);
  return parse(std::move(contents), path, diagnostics);
}

std::optional<ConfigNode> ConfigNode::parse(std::string contents, const std::string& path,
                                            Diagnostics& diagnostics) {
  if (contents.size() > kMaxBytes) {
    diagnostics.add({path, 1, 1, "larger than 1 MiB"});
    return std::nullopt;
  }
  // yaml-cpp skips a byte order mark as well, but then counts it.
  if (constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
      contents.starts_with(kByteOrderMark)) {
    contents.erase(0, kByteOrderMark.size());
  }
  const auto source =
      std::make_shared<const Source>(Source{path, std::move(contents), &diagnostics});
  const auto failure_at = [&](std::size_t position, const std::string& message) {
    YAML::Mark mark;
    mark.pos = static_cast<int>(position);
    source->error(mark, message);
    return std::nullopt;
  };

  // yaml-cpp replaces invalid UTF-8 in silence and has its own uses for some control characters.
  const auto invalid = find_invalid_utf8(source->contents);
  if (invalid != std::string::npos) {
    return failure_at(invalid, "not valid UTF-8; save the file as UTF-8");
  }
  const auto control = std::ranges::find_if(source->contents, [](char c) {
    return is_control(c) && c != '\t' && c != '\n' && c != '\r';
  });
  if (control != source->contents.end()) {
    return failure_at(static_cast<std::size_t>(control - source->contents.begin()),
                      "control character; is this a text file?");
  }

  YAML::Node root;
  DocumentStarts documents;
  try {
    // Not YAML::LoadAll, which finds documents without end where text belongs to nothing.
    std::istringstream stream(source->contents);
    YAML::Parser parser(stream);
    while (documents.starts().size() < 2 && parser.HandleNextDocument(documents)) {
    }
    root = YAML::Load(source->contents);
  } catch (const YAML::DeepRecursion& error) {  // has no useful message
    source->error(error.mark, too_deep());
    return std::nullopt;
  } catch (const YAML::Exception& error) {
    const bool tab = error.msg.find("tab") != std::string::npos;
    source->error(error.mark, "not valid YAML: " + error.msg + (tab ? "; indent with spaces" : ""));
    return std::nullopt;
  }
  if (documents.starts().size() > 1) {
    const auto& [document, content] = documents.starts()[1];
    const std::string_view remaining =
        std::string_view(source->contents).substr(static_cast<std::size_t>(document.pos));
    if (remaining.starts_with("---"))
      source->error(content,
                    "only one document is allowed; remove the '---' above and what follows it");
    else
      source->error(document,
                    "not valid YAML: " + in_quotes(remaining.substr(0, remaining.find('\n'))) +
                        " is not part of the document above");
    return std::nullopt;
  }
  if (!ConfigCheck(*source).run(root)) return std::nullopt;
  return ConfigNode(root, "the file", source);
}

ConfigNode::ConfigNode(const YAML::Node& node, std::string name,
                       std::shared_ptr<const Source> source)
    : node_(node), mark_(node_.Mark()), name_(std::move(name)), source_(std::move(source)) {}

ConfigNode ConfigNode::child(const YAML::Node& node, std::string name) const {
  return ConfigNode(node, std::move(name), source_);
}

const std::string& ConfigNode::file() const { return source_->path; }
const std::string& ConfigNode::contents() const { return source_->contents; }

std::filesystem::path ConfigNode::directory() const {
  return std::filesystem::path(source_->path).parent_path();
}

std::string ConfigNode::text() const { return is_scalar() ? node_.Scalar() : std::string(); }

void ConfigNode::error(std::string message) const { source_->error(mark_, std::move(message)); }

void ConfigNode::reject_type(const std::string& wanted) const {
  const std::string found = is_map()                      ? "a map"
                            : is_sequence()               ? "a list"
                            : is_null() || text().empty() ? "empty"
                                                          : in_quotes(text());
  error(name_ + " must be " + wanted + ", not " + found);
}

std::optional<std::string> ConfigNode::as_string() const {
  const std::string value = text();
  if (value.empty()) {
    reject_type("text");
    return std::nullopt;
  }
  if (!is_sanitized(value)) {  // it would break the lines of messages and reports
    error(name_ + " must be one line without control characters, not " + in_quotes(value));
    return std::nullopt;
  }
  return value;
}

std::optional<bool> ConfigNode::as_bool() const {
  const std::string value = text();
  if (value == "true") return true;
  if (value == "false") return false;
  reject_type("true or false");
  return std::nullopt;
}

std::optional<std::int64_t> ConfigNode::as_integer(std::int64_t lower, std::int64_t upper) const {
  const std::string value = text();
  std::int64_t number = 0;
  const auto remaining = read_number(value, number);
  if (!remaining || !remaining->empty() || number < lower || number > upper) {
    reject_type("a whole number between " + std::to_string(lower) + " and " +
                std::to_string(upper));
    return std::nullopt;
  }
  return number;
}

std::optional<double> ConfigNode::as_number(double lower, double upper) const {
  return as_quantity("1", lower, upper);
}

std::optional<double> ConfigNode::as_quantity(std::string_view si_unit, double lower,
                                              double upper) const {
  const bool dimensionless = is_dimensionless(si_unit);
  const std::string si_text = dimensionless ? std::string() : ' ' + std::string(si_unit);

  const std::string value = text();
  double number = 0.0;
  const auto remaining = read_number(trimmed(value), number);
  if (!remaining) {
    reject_type(dimensionless ? "a number"
                              : "a number with a unit, for example '1" + si_text + "'");
    return std::nullopt;
  }
  if (const std::string_view unit = trimmed(*remaining); !unit.empty()) {
    const auto factor = unit_factor(unit, si_unit);
    if (const auto* problem = std::get_if<UnitError>(&factor)) {
      error(name_ + ": " + problem->message);
      return std::nullopt;
    }
    number *= std::get<double>(factor);
  } else if (!dimensionless) {
    error(name_ + " needs a unit, for example '" + shortened(value) + si_text + "'");
    return std::nullopt;
  }

  if (!std::isfinite(number)) {
    error(name_ + " is too large: " + shortened(value));
    return std::nullopt;
  }
  number = snapped(snapped(number, lower), upper);
  if (number < lower || number > upper) {
    error(name_ + " must " + range_text(lower, upper, si_text) + ", not " + shortened(value));
    return std::nullopt;
  }
  return number;
}

std::optional<std::pair<double, double>> ConfigNode::as_bounds(std::string_view si_unit,
                                                               double lower, double upper) const {
  if (!is_sequence() || node_.size() != 2) {
    error(name_ + " must be a list of two values: [lower, upper]");
    return std::nullopt;
  }
  const std::vector<ConfigNode> values = *as_sequence();
  const auto first = values[0].as_quantity(si_unit, lower, upper);
  const auto second = values[1].as_quantity(si_unit, lower, upper);
  if (!first || !second) return std::nullopt;
  if (!(*first < *second)) {
    error(name_ + " must be given as [lower, upper], but " + shortened(values[0].text()) +
          " is not less than " + shortened(values[1].text()));
    return std::nullopt;
  }
  return std::pair(*first, *second);
}

std::optional<std::size_t> ConfigNode::as_choice(std::span<const std::string> allowed) const {
  const std::string value = text();
  if (const auto found = std::ranges::find(allowed, value); found != allowed.end()) {
    return static_cast<std::size_t>(found - allowed.begin());
  }
  if (value.empty()) {
    reject_type("one of " + joined(allowed));
  } else {
    error(name_ + " must be one of " + joined(allowed) + ", not " + in_quotes(value) +
          suggestion(value, allowed));
  }
  return std::nullopt;
}

std::optional<std::vector<ConfigNode>> ConfigNode::as_sequence() const {
  if (!is_sequence()) {
    reject_type("a list");
    return std::nullopt;
  }
  std::vector<ConfigNode> result;
  result.reserve(node_.size());
  for (const YAML::Node& entry : node_) {
    result.push_back(child(entry, "entry " + std::to_string(result.size() + 1) + " of " + name_));
  }
  return result;
}

ConfigMap::ConfigMap(const ConfigNode& node) : node_(node) {
  if (!node.is_map()) {
    node.reject_type("a map of keys and values");
    return;
  }
  for (const auto& pair : node.node_) {
    // Reported when the file was loaded.
    if (!pair.first.IsScalar() || pair.first.Scalar() == kMergeKey) continue;
    const std::string name = shortened(pair.first.Scalar());
    Entry entry{node.child(pair.first, name), node.child(pair.second, name)};
    // yaml-cpp places an empty value where the next one starts.
    if (entry.value.is_null()) entry.value.mark_ = entry.key.mark_;
    entries_.push_back(std::move(entry));
  }
}

std::optional<ConfigNode> ConfigMap::required(std::string_view key) {
  auto value = optional(key);
  if (value || !node_.is_map()) return value;
  if (const auto meant = misspelling_of(key); meant != entries_.end()) {
    const std::string text = meant->key.text();
    meant->key.error("unknown key " + in_quotes(text) +
                     suggestion(text, std::array{std::string(key)}));
    entries_.erase(meant);
    all_known_ = false;
  } else {
    node_.error("key " + in_quotes(key) + " is missing in " + node_.name());
  }
  return value;
}

std::vector<ConfigMap::Entry>::iterator ConfigMap::misspelling_of(std::string_view key) {
  if (keys_ == nullptr) return entries_.end();
  std::vector<std::string> names;
  for (const Key& known : *keys_) names.push_back(known.name);
  return std::ranges::find_if(entries_, [&](const Entry& entry) {
    const std::string text = entry.key.text();
    return std::ranges::find(names, text) == names.end() && closest_match(text, names) == key;
  });
}

const Key& ConfigMap::described(std::string_view key) const {
  if (keys_ == nullptr) throw std::logic_error("the keys of this map are not described");
  return find_key(*keys_, key);
}

std::optional<ConfigNode> ConfigMap::given(std::string_view key) {
  return described(key).is_required ? required(key) : optional(key);
}

std::optional<ConfigNode> ConfigMap::optional(std::string_view key) {
  if (keys_ != nullptr) described(key);
  if (std::ranges::find(known_, key) == known_.end()) known_.emplace_back(key);
  const auto found =
      std::ranges::find_if(entries_, [key](const Entry& entry) { return entry.key.text() == key; });
  if (found == entries_.end()) return std::nullopt;
  return found->value;
}

const std::vector<ConfigMap::Entry>& ConfigMap::entries() {
  any_key_ = true;
  return entries_;
}

bool ConfigMap::finish() const {
  if (any_key_) return true;
  bool all_known = all_known_;
  for (const Entry& entry : entries_) {
    const std::string key = entry.key.text();
    if (std::ranges::find(known_, key) != known_.end()) continue;
    std::string hint = suggestion(key, known_);
    if (hint.empty() && !known_.empty()) hint = "; known keys: " + joined(known_);
    entry.key.error("unknown key " + in_quotes(key) + hint);
    all_known = false;
  }
  return all_known;
}

std::string with_comment(const std::string& comment, const std::string& yaml) {
  std::string text;
  for (std::size_t at = 0; at < comment.size();) {
    const std::size_t end = std::min(comment.find('\n', at), comment.size());
    text += "# " + sanitized(comment.substr(at, end - at)) + "\n";
    at = end + 1;
  }
  return text + yaml + "\n";
}

}  // namespace axisfit
