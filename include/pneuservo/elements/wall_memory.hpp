// Friction and wall heat that depend on frequency: what the layers at a pipe's wall remember of how the gas has
// changed.
#pragma once
#include <array>

#include <pneuservo/core/group.hpp>

namespace pneuservo {

/// A change of the mean velocity (temperature) reaches the wall's layer at once and fades from it by diffusion, so that
/// the shear (heat flux) at the wall is the quasi-steady one and beside it 4 mu/R^2 (4 k/R^2) times sum y_i + c R^2/nu
/// du/dt per volume, with dy_i/dt = -n_i (nu/R^2) y_i + m_i du/dt (Zielke 1968 in the recursive form of Trikha 1975 and
/// Kagawa et al. 1983); c stands for all layers thinner than those, which add to the inertia alone. The weights are a
/// fit of this project to the exact laminar theory: within 0.5 % up to s R^2/nu = 2e3i, 2 % up to 1e4i, and within 1.1
/// % over times nu t/R^2 = 1e-3 .. 0.3, 2.7 % from 1e-4 (wall_memory_test). In turbulent flow the layer is renewed:
/// every n_i grows by `renewal`.
template <class V> struct WallLayer {
  static constexpr int terms = 5;
  static constexpr std::array<double, terms> decay{26.418507, 85.270992, 351.64883, 1751.1674, 9992.3097};
  static constexpr std::array<double, terms> weight{1.0104901, 1.7753544, 4.6006731, 11.049918, 29.986457};
  static constexpr double inertia = 1.8348914e-3;

  std::array<V, terms> kept{};  ///< of each y_i over a step
  std::array<V, terms> taken{};  ///< of the change of the step; a memory holds y_i over it
  std::array<V, terms> told{};  ///< of what a memory holds: y_i in the mean of the next step
  V answer{};  ///< to the change of the step, in its mean

  WallLayer() noexcept = default;
  /// Steps of length h: tau = nu h/R^2. e^-x by 1/(1 + x + x^2/2), which no x makes unstable.
  WallLayer(const V& tau, const V& renewal) noexcept {
    for (std::size_t i = 0; i < terms; ++i) {
      const V half = V(0.5) * tau * (V(decay[i]) + renewal);
      kept[i] = V(1) / (V(1) + V(2) * half * (V(1) + half));
      taken[i] = V(weight[i]) * (V(1) + half) * kept[i];
      told[i] = V(0.5) * taken[i] * (V(1) + kept[i]);
      answer += V(0.5) * taken[i];
    }
    answer += V(inertia) / tau;
  }
  /// The layer that stands at one place of a group, at all of its places.
  template <class S> WallLayer repeated(int place) const noexcept {
    WallLayer out;
    for (std::size_t i = 0; i < terms; ++i) {
      out.kept[i] = replicate(element<S>(kept[i], place));
      out.taken[i] = replicate(element<S>(taken[i], place));
      out.told[i] = replicate(element<S>(told[i], place));
    }
    out.answer = replicate(element<S>(answer, place));
    return out;
  }
};

/// What a memory adds to an implicit balance of v: `source` above, `conductance` below.
template <class V> struct WallAnswer {
  V conductance, source;
};
/// factor times the mean of sum y_i, of which `kept` is there before the step; conductance: factor times the layer's
/// answer.
template <class V> [[gnu::always_inline]] inline WallAnswer<V> wall_answer(const V& conductance, const V& factor,
                                                                           const V& kept, const V& v) noexcept {
  return {conductance, conductance * v - factor * kept};
}

/// The y_i of one place, each over `taken`, and what the next step has of them.
template <class V> class WallMemory {
 public:
  void forget() noexcept {
    held_.fill(V(0));
    kept_ = V(0);
  }
  /// Of the mean of sum y_i over a step: what is kept of what was before, beside `answer` times the change of the step.
  [[gnu::always_inline]] const V& kept() const noexcept { return kept_; }
  /// Ends a step with the change that it has brought.
  [[gnu::always_inline]] void advance(const WallLayer<V>& layer, const V& change) noexcept {
    kept_ = V(0);
    for (std::size_t i = 0; i < WallLayer<V>::terms; ++i) {
      held_[i] = layer.kept[i] * held_[i] + change;
      kept_ += layer.told[i] * held_[i];
    }
  }
  /// Forgets what is no number, lane by lane.
  void mend() noexcept {
    for (V& held : held_) held = select(is_number(held), held, V(0));
    kept_ = select(is_number(kept_), kept_, V(0));
  }
  /// The steps get another length: the y_i stay.
  void change_layer(const WallLayer<V>& from, const WallLayer<V>& to) noexcept {
    kept_ = V(0);
    for (std::size_t i = 0; i < WallLayer<V>::terms; ++i) {
      held_[i] *= from.taken[i] / to.taken[i];
      kept_ += to.told[i] * held_[i];
    }
  }

 private:
  std::array<V, WallLayer<V>::terms> held_{};
  V kept_{};
};

}  // namespace pneuservo
