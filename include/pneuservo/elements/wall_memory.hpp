// Friction and wall heat that depend on frequency: what the layers at a pipe's wall remember of how the gas has
// changed.
#pragma once
#include <array>

#include <pneuservo/core/group.hpp>

namespace pneuservo {

/// A change of the mean velocity (temperature) reaches the wall's layer at once and fades from it by diffusion, so that
/// the shear (heat flux) at the wall is the quasi-steady one and beside it 4 mu/R^2 sum y_i (4 k/R^2 sum y_i) per
/// volume, with dy_i/dt = -n_i (nu/R^2) y_i + m_i du/dt (Zielke 1968 in the recursive form of Trikha 1975 and Kagawa et
/// al. 1983). The weights are a fit of this project to the exact laminar theory, within 2.1 % over s R^2/nu = 0.3i ..
/// 3e4i and within 1.2 % over times nu t/R^2 = 1e-4 .. 0.3 (wall_memory_test). In turbulent flow the layer is renewed:
/// every n_i grows by `renewal`.
template <class V> struct WallLayer {
  static constexpr int terms = 6;
  static constexpr std::array<double, terms> decay{26.491279, 89.542445, 376.08019, 1849.9928, 9664.7411, 90925.140};
  static constexpr std::array<double, terms> weight{1.0263364, 1.8959607, 4.7458679, 11.116298, 26.618057, 182.55127};

  std::array<V, terms> kept{};  ///< of each y_i over a step
  std::array<V, terms> taken{};  ///< of the change of the step
  V answer{};  ///< half the sum of taken

  WallLayer() noexcept = default;
  /// Steps of length h: tau = nu h/R^2. e^-x by 1/(1 + x + x^2/2), which no x makes unstable.
  WallLayer(const V& tau, const V& renewal) noexcept {
    for (std::size_t i = 0; i < terms; ++i) {
      const V half = V(0.5) * tau * (V(decay[i]) + renewal);
      kept[i] = V(1) / (V(1) + V(2) * half * (V(1) + half));
      taken[i] = V(weight[i]) * (V(1) + half) * kept[i];
      answer += V(0.5) * taken[i];
    }
  }
  /// The same layer beside several neighbours at once.
  template <class G> WallLayer<G> grouped() const noexcept {
    WallLayer<G> out;
    for (std::size_t i = 0; i < terms; ++i) {
      out.kept[i] = replicate(kept[i]);
      out.taken[i] = replicate(taken[i]);
    }
    out.answer = replicate(answer);
    return out;
  }
};

/// What a memory adds to an implicit balance of v: `source` above, `conductance` below.
template <class V> struct WallAnswer {
  V conductance, source;
};

/// The y_i of one place.
template <class V> class WallMemory {
 public:
  void forget() noexcept { y_.fill(V(0)); }
  /// Of the mean of sum y_i over a step: what is kept of what was before, beside `answer` times the change of the step.
  [[gnu::always_inline]] V kept(const WallLayer<V>& layer) const noexcept {
    V sum(0);
    for (std::size_t i = 0; i < WallLayer<V>::terms; ++i) sum += y_[i] + layer.kept[i] * y_[i];
    return V(0.5) * sum;
  }
  /// factor times that mean, on a balance of v.
  [[gnu::always_inline]] WallAnswer<V> answer(const WallLayer<V>& layer, const V& factor, const V& v) const noexcept {
    return {factor * layer.answer, factor * (layer.answer * v - kept(layer))};
  }
  /// Ends a step with the change that it has brought.
  [[gnu::always_inline]] void advance(const WallLayer<V>& layer, const V& change) noexcept {
    const V sound = select(is_number(change), change, V(0));
    for (std::size_t i = 0; i < WallLayer<V>::terms; ++i) y_[i] = layer.kept[i] * y_[i] + layer.taken[i] * sound;
  }

 private:
  std::array<V, WallLayer<V>::terms> y_{};
};

}  // namespace pneuservo
