#include "base/units.h"

#include <fmt/format.h>
#include <udunits2.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <stdexcept>
#include <utility>

namespace axisfit {
namespace {

template <auto free_function>
struct Free {
  template <typename T>
  void operator()(T* pointer) const {
    free_function(pointer);
  }
};
using System = std::unique_ptr<ut_system, Free<ut_free_system>>;
using Unit = std::unique_ptr<ut_unit, Free<ut_free>>;
using Converter = std::unique_ptr<cv_converter, Free<cv_free>>;

/// Throws std::bad_alloc where there is no memory of so many bytes, which the library then asks
/// for: it does not look whether it was given any.
void expect_memory(std::size_t bytes) { ::operator delete(::operator new(bytes)); }

using Replacement = std::pair<std::string_view, std::string_view>;

// Writings that udunits does not know, in its own words. As symbols they take prefixes: "kNm".
constexpr auto kExtraSymbols = std::to_array<Replacement>({
    {"deg", "arc_degree"},
    {"rev", "turn"},
    {"Nm", "N m"},
    {"Nmm", "N mm"},
    {"Nms", "N m s"},
    {"Ns", "N s"},
    {"Vs", "V s"},
    {"As", "A s"},
    {"Ah", "A h"},
    {"Ws", "W s"},
    {"Wh", "W h"},
});

constexpr auto kPlainWritings = std::to_array<Replacement>({
    {"\u00B7", "*"},          // middle dot
    {"\u22C5", "*"},          // dot operator
    {"\u00D7", "*"},          // multiplication sign
    {"\u207B\u00B9", "^-1"},  // superscripts, negative first
    {"\u207B\u00B2", "^-2"},
    {"\u207B\u00B3", "^-3"},
    {"\u00B9", "^1"},
    {"\u00B2", "^2"},
    {"\u00B3", "^3"},
    {"\u2212", "-"},  // minus sign
    {"\u00A0", " "},  // no-break spaces
    {"\u202F", " "},
});

// Typographical signs become ASCII; spaces at the ends and around '*' and '/' go, because udunits
// takes them for syntax errors.
std::string normalized(std::string_view text) {
  std::string plain;
  while (!text.empty()) {
    std::size_t taken = 0;
    for (const auto& [sign, replacement] : kPlainWritings) {
      if (!text.starts_with(sign)) continue;
      plain += replacement;
      taken = sign.size();
      break;
    }
    if (taken == 0) {
      plain += text.front();
      taken = 1;
    }
    text.remove_prefix(taken);
  }

  const auto is_operator = [](char c) { return c == '*' || c == '/'; };
  std::string result;
  for (const char c : plain) {
    if (c == ' ' && (result.empty() || is_operator(result.back()))) continue;
    if (is_operator(c)) {
      while (result.ends_with(' ')) result.pop_back();
    }
    result += c;
  }
  while (result.ends_with(' ')) result.pop_back();
  return result;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Part of the name of a unit; every byte of a character beyond ASCII counts ("Ω", "µm", "°").
bool is_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '%' ||
         static_cast<unsigned char>(c) >= 0x80;
}

// udunits understands far more than units: "m^0.5" is half a dimensionless one, "m s -1" is minus
// one m s, "K @ 273" has an offset. Lets pass only names, their whole powers from -9 to 9,
// products, quotients and the number 1.
bool is_product_of_powers(std::string_view text) {
  constexpr std::size_t kMaxLength = 64;
  if (text.empty() || text.size() > kMaxLength) return false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char before = i == 0 ? '\0' : text[i - 1];
    const char c = text[i];
    const char after = i + 1 < text.size() ? text[i + 1] : '\0';
    if (is_digit(c)) {
      if (is_digit(after)) return false;
      const bool exponent = before == '^' || before == '-' || is_name(before);
      if (!exponent && c != '1') return false;
    } else if (c == '-') {
      if (before != '^' && !is_name(before)) return false;
      if (!is_digit(after) && !is_name(after)) return false;
    } else if (c == '.') {
      if (!is_name(after)) return false;
    } else if (!is_name(c) && std::string_view("^*/() ").find(c) == std::string_view::npos) {
      return false;
    }
  }
  return true;
}

bool mentions_hertz(std::string_view text) {
  return text.find("Hz") != std::string_view::npos || text.find("ertz") != std::string_view::npos;
}

// The unit database with the extra symbols. udunits keeps global state while it parses, hence the
// lock around every use.
class Database {
 public:
  // Throws std::runtime_error when the database cannot be loaded; the next call tries again.
  static Database& instance() {
    static Database database;
    return database;
  }

  std::mutex& mutex() { return mutex_; }

  // Null when `text` is not a product of powers of units.
  Unit parse(std::string_view text) const {
    const std::string plain = normalized(text);
    if (!is_product_of_powers(plain)) return nullptr;
    expect_memory(100'000);  // a parse takes less than a kilobyte, and what follows little more
    return Unit(ut_parse(system_.get(), plain.c_str(), UT_UTF8));
  }

  bool is_dimensionless(const Unit& unit) const {
    return ut_are_convertible(unit.get(), one_.get()) != 0 && radian_power(unit) == 0;
  }

  // udunits converts freely between radians and plain numbers. Their power shows only in the
  // definition, for example "0.104 s-1.rad".
  static int radian_power(const Unit& unit) {
    std::array<char, 256> definition{};
    const int length = ut_format(unit.get(), definition.data(), definition.size(),
                                 static_cast<unsigned>(UT_ASCII) | UT_DEFINITION);
    if (length < 0) return 0;
    const std::string_view text(definition.data());
    const std::size_t found = text.find("rad");  // the other base units are m kg s A K mol cd
    if (found == std::string_view::npos) return 0;
    const int power = std::atoi(definition.data() + found + 3);
    return power == 0 ? 1 : power;
  }

 private:
  Database() {
    ut_set_error_message_handler(ut_ignore);  // otherwise it writes to stderr
    expect_memory(1'000'000);                 // reading takes 0.42 MB at most
    system_.reset(ut_read_xml(nullptr));
    if (system_ == nullptr) {
      throw std::runtime_error(
          "cannot load the unit database of udunits2: install the package libudunits2-data and "
          "check that UDUNITS2_XML_PATH, if set, names its udunits2.xml");
    }
    one_.reset(ut_get_dimensionless_unit_one(system_.get()));
    for (const auto& [symbol, meaning] : kExtraSymbols) {
      const Unit unit(ut_parse(system_.get(), meaning.data(), UT_UTF8));
      // A database that has the symbol already (UT_EXISTS) keeps its own.
      ut_map_symbol_to_unit(symbol.data(), UT_UTF8, unit.get());
    }
  }

  System system_;
  Unit one_;
  std::mutex mutex_;
};

// A database, locked, and the parsed unit of a quantity.
struct Target {
  explicit Target(std::string_view si_unit)
      : database(Database::instance()), lock(database.mutex()), unit(database.parse(si_unit)) {
    if (unit == nullptr) throw std::invalid_argument("not a unit: " + std::string(si_unit));
  }

  Database& database;
  std::scoped_lock<std::mutex> lock;
  Unit unit;
};

}  // namespace

std::variant<double, UnitError> unit_factor(std::string_view unit, std::string_view si_unit) {
  const Target target(si_unit);
  const bool dimensionless = target.database.is_dimensionless(target.unit);
  const auto failure = [&](UnitProblem problem, std::string message) {
    message += dimensionless ? "; use a plain number or '%'" : "; use for example '";
    if (!dimensionless) message.append(si_unit) += '\'';
    return UnitError{problem, std::move(message)};
  };
  const std::string quoted = fmt::format("'{}'", unit);

  const Unit given = target.database.parse(unit);
  if (given == nullptr) return failure(UnitProblem::unknown, "unknown unit " + quoted);

  const int radians = Database::radian_power(given);
  const bool radians_agree =
      radians == Database::radian_power(target.unit) ||
      (radians == 0 && !target.database.is_dimensionless(given) && !mentions_hertz(unit));
  if (ut_are_convertible(given.get(), target.unit.get()) == 0 || !radians_agree) {
    return failure(
        UnitProblem::wrong_dimension,
        quoted + (dimensionless ? " cannot be used for a dimensionless quantity"
                                : " cannot be converted to '" + std::string(si_unit) + "'"));
  }

  const Converter converter(ut_get_converter(given.get(), target.unit.get()));
  const double zero = cv_convert_double(converter.get(), 0.0);
  const double factor = cv_convert_double(converter.get(), 1.0);
  if (zero != 0.0 || !std::isfinite(factor) || factor <= 0.0) {
    return failure(UnitProblem::not_proportional, quoted + " is not proportional to it");
  }
  return factor;
}

bool is_dimensionless(std::string_view si_unit) {
  const Target target(si_unit);
  return target.database.is_dimensionless(target.unit);
}

std::string with_unit(std::string number, std::string_view si_unit) {
  if (!is_dimensionless(si_unit)) number.append(" ").append(si_unit);
  return number;
}

std::string with_unit(double value, std::string_view si_unit) {
  return with_unit(fmt::format("{}", value), si_unit);
}

}  // namespace axisfit
