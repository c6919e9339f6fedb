// The controller section of a config: the law by its name, and the parameters of each law of the list.
#pragma once
#include <optional>

#include <pneuservo/control/laws.hpp>

namespace pneuservo {

/// The control law and its parameters; the keys follow the kind. What a law may lack has a neutral value here.
struct ControllerParameters {
  ControllerKind kind{};
  Laws::Parameters laws;

  template <class L> typename L::Parameters& of() noexcept { return std::get<Laws::number<L>()>(laws); }
  template <class L> const typename L::Parameters& of() const noexcept { return std::get<Laws::number<L>()>(laws); }
  template <class L> bool is() const noexcept { return kind == kind_of<L>; }
  std::string_view name() const noexcept { return name_of(kind); }

  /// function(parameters) with those of the law in use.
  template <class F> decltype(auto) in_use(F&& function) const {
    return with_law(kind, [&]<class L>(LawTag<L>) -> decltype(auto) { return function(this->template of<L>()); });
  }
  template <class F> decltype(auto) in_use(F&& function) {
    return with_law(kind, [&]<class L>(LawTag<L>) -> decltype(auto) { return function(this->template of<L>()); });
  }

  /// Whether the config chooses the pressures that close a force loop.
  bool closes_force_loop() const noexcept {
    return in_use([](const auto& p) { return requires { p.pressure_source; }; });
  }
  void choose_pressures(PressureSource source) noexcept {
    in_use([source](auto& p) {
      if constexpr (requires { p.pressure_source; }) p.pressure_source = source;
    });
  }
  /// Pressures that the law takes, if any.
  std::optional<PressureSource> pressures() const noexcept {
    return in_use([](const auto& p) -> std::optional<PressureSource> {
      if constexpr (requires { p.pressures(); }) return p.pressures();
      else if constexpr (requires { p.pressure_source; }) return p.pressure_source;
      else return std::nullopt;
    });
  }
  bool takes_chambers() const noexcept { return pressures() == PressureSource::chamber; }
  bool takes_differences() const noexcept { return pressures() == PressureSource::differential; }
  /// Whether the force loop closes on the ports' pressures, alone or by a modal filter.
  bool feeds_back_ports() const noexcept {
    return in_use([](const auto& p) {
      if constexpr (requires { p.feeds_back_ports(); }) return p.feeds_back_ports();
      else return false;
    });
  }
  /// Time constant of the law's velocity filter; 0: none that is known [s].
  double velocity_filter_s() const noexcept {
    return in_use([](const auto& p) {
      if constexpr (requires { p.velocity_filter_s; }) return p.velocity_filter_s;
      else return 0.0;
    });
  }
  /// Delay from command to valve that the law makes up for [s].
  double command_delay_s() const noexcept {
    return in_use([](const auto& p) {
      if constexpr (requires { p.command_delay_s; }) return p.command_delay_s;
      else return 0.0;
    });
  }
  std::string_view feedforward_name() const noexcept {
    return in_use([](const auto& p) -> std::string_view {
      if constexpr (requires { p.feedforward_name(); }) return p.feedforward_name();
      else return "none";
    });
  }
  /// Whether the law follows a command pass along the reference.
  bool wants_pass() const noexcept {
    return in_use([](const auto& p) {
      if constexpr (requires { p.wants_pass(); }) return p.wants_pass();
      else return false;
    });
  }
  /// Pressure of both sides before the first move, where the law has one.
  std::optional<double> rest_pressure_Pa() const noexcept {
    return in_use([](const auto& p) -> std::optional<double> {
      if constexpr (requires { p.rest_pressure_Pa(); }) return p.rest_pressure_Pa();
      else return std::nullopt;
    });
  }

  template <class V, class First, class... Rest> static void visit(V&& v, First& first, Rest&... rest) {
    v(Field{"kind", "", 0, 0, "control law", Presence::required, controller_kind_names}, first.kind, rest.kind...);
    with_law(first.kind,
             [&]<class L>(LawTag<L>) { L::Parameters::visit(v, first.template of<L>(), rest.template of<L>()...); });
  }
  /// The loop of position and velocity alone, of a drive that gives its force at once.
  template <class V, class First, class... Rest> static void visit_outer_loop(V&& v, First& first, Rest&... rest) {
    v(Field{"kind", "", 0, 0, "control law", Presence::required, controller_kind_names}, first.kind, rest.kind...);
    with_law(first.kind, [&]<class L>(LawTag<L>) {
      if constexpr (HasOuterLoop<L>)
        L::Parameters::visit_outer_loop(v, first.template of<L>(), rest.template of<L>()...);
    });
  }
};

}  // namespace pneuservo
