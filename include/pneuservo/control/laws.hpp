// The list of control laws: one include a law, in the order of their numbers (LawAt). All else follows from it.
#pragma once
#include <pneuservo/control/pd_force.hpp>
#include <pneuservo/control/ppd2.hpp>
#include <pneuservo/control/pressure_pi.hpp>

#include <span>
#include <tuple>
#include <utility>
#include <variant>

namespace pneuservo {

template <std::size_t Number>
concept IsListed = requires { typename LawAt<Number>::Law; };

template <std::size_t Number = 0> consteval std::size_t count_laws() {
  if constexpr (IsListed<Number>) return count_laws<Number + 1>();
  else return Number;
}
inline constexpr std::size_t law_count = count_laws();
static_assert(!IsListed<law_count + 1> && !IsListed<law_count + 2>, "a law's LawAt leaves out the next free number");

/// Which law; its value is the law's number.
enum class ControllerKind : std::uint8_t {};

/// Stands for the law in a call.
template <class L> struct LawTag {
  using Law = L;
};

/// function(LawTag<L>{}) with the law of that kind.
template <std::size_t Number = 0, class F> constexpr decltype(auto) with_law(ControllerKind kind, F&& function) {
  if constexpr (Number + 1 < law_count)
    if (static_cast<std::size_t>(kind) != Number) return with_law<Number + 1>(kind, std::forward<F>(function));
  return function(LawTag<typename LawAt<Number>::Law>{});
}

template <class L> constexpr bool is_a_law() {
  static_assert(HasName<L>, "a law has: static constexpr std::string_view name");
  static_assert(DrivesValves<L>, "a law has: static constexpr int valves, 1 or 2");
  static_assert(HasParameters<L>, "a law has: struct Parameters with visit(v, p...)");
  static_assert(Configures<L>, "a law has: configure(const Parameters&, const LawSetup&)");
  static_assert(Resets<L>, "a law has: reset(const std::array<double, 2>& previous_V) noexcept");
  static_assert(Steps<L>, "a law has: ControlOutput step(const ControlInput&) noexcept");
  static_assert(Skips<L>, "a law has: skip(std::int64_t periods) noexcept");
  static_assert(HasTerms<L>, "a law has: struct Terms with visit(v, t...), and const Terms& terms() const noexcept");
  static_assert(KnowsRest<L>, "a law of two valves has: double Parameters::rest_pressure_Pa() const");
  return ControlLaw<L>;
}

template <class Numbers> struct LawsOf;
template <std::size_t... Number> struct LawsOf<std::index_sequence<Number...>> {
  static_assert((is_a_law<typename LawAt<Number>::Law>() && ...));
  using Variant = std::variant<typename LawAt<Number>::Law...>;
  using Parameters = std::tuple<typename LawAt<Number>::Law::Parameters...>;
  static constexpr std::array<std::string_view, law_count> names{LawAt<Number>::Law::name...};
  template <class L> static consteval std::size_t number() {
    std::size_t found = law_count;
    ((std::is_same_v<L, typename LawAt<Number>::Law> ? void(found = Number) : void()), ...);
    return found;
  }
};
using Laws = LawsOf<std::make_index_sequence<law_count>>;

template <class L> inline constexpr ControllerKind kind_of{static_cast<std::uint8_t>(Laws::number<L>())};
inline constexpr const auto& controller_kind_names = Laws::names;
constexpr std::string_view name_of(ControllerKind kind) {
  return controller_kind_names[static_cast<std::size_t>(kind)];
}

template <class L> inline constexpr std::array<LawTerm, term_count<L>()> terms_of_law = [] {
  std::array<LawTerm, term_count<L>()> terms;
  std::size_t i = 0;
  L::Terms::visit([&](const LawTerm& term) { terms[i++] = term; });
  return terms;
}();
template <class L> inline constexpr auto term_names_of_law = [] {
  std::array<std::string_view, term_count<L>()> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = terms_of_law<L>[i].name;
  return names;
}();

/// What the law records, in the order of its columns.
constexpr std::span<const LawTerm> law_terms(ControllerKind kind) {
  return with_law(kind, []<class L>(LawTag<L>) { return std::span<const LawTerm>(terms_of_law<L>); });
}
/// Names of those columns.
constexpr std::span<const std::string_view> law_columns(ControllerKind kind) {
  return with_law(kind, []<class L>(LawTag<L>) { return std::span<const std::string_view>(term_names_of_law<L>); });
}

}  // namespace pneuservo
