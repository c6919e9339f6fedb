// What the layers at a line's wall remember, face by face and cell by cell: friction and heat that depend on frequency.
#pragma once
#include <array>
#include <vector>

#include <pneuservo/core/group.hpp>
#include <pneuservo/elements/wall_memory.hpp>

namespace pneuservo {

/// One layer for the whole line, of its mean density, temperature and speed: what it remembers differs from place to
/// place, how it fades hardly does, and density and turbulence change slowly beside the waves.
template <class S> class LineMemory {
 public:
  using G = Group<S>;
  enum class End : std::size_t { port, chamber };
  /// What the layers are made of: diffusion h/R^2 of momentum mu [Pa s] and heat k [W/(m K)], density, and how fast
  /// turbulence renews them, in nu/R^2.
  struct Gas {
    S flow_diffusion, heat_diffusion, density_kg_per_m3, specific_heat_J_per_kgK, renewal;
  };

  void resize(std::size_t face_groups, std::size_t cell_groups) {
    faces_.assign(face_groups, {});
    cells_.assign(cell_groups, {});
  }
  /// share: of the theory of laminar layers; 0: nothing is remembered.
  void set_share(const S& share, const S& gas_constant_J_per_kgK) noexcept {
    is_present_ = any(share > S(0));
    factor_ = S(4) * share;
    cell_factor_ = replicate(factor_);
    gas_constant_ = replicate(gas_constant_J_per_kgK);
  }
  bool is_present() const noexcept { return is_present_; }
  void forget() noexcept {
    for (auto* places : {&faces_, &cells_})
      for (WallMemory<G>& place : *places) place.forget();
    for (WallMemory<S>& end : ends_) end.forget();
    renew();
  }
  /// The layers are wanted anew in the next step: its length is another.
  void renew() noexcept { step_ = 0; }
  /// Once a step: whether it wants its layers anew.
  bool begin_step() noexcept { return step_++ % steps_between_layers == 0; }
  void set_layers(const Gas& gas) noexcept {
    flow_layer_ = WallLayer<S>(gas.flow_diffusion / gas.density_kg_per_m3, gas.renewal);
    flow_factor_ = factor_ * gas.flow_diffusion;
    face_layer_ = flow_layer_.template grouped<G>();
    face_factor_ = replicate(flow_factor_);
    cell_layer_ = WallLayer<S>(gas.heat_diffusion / (gas.density_kg_per_m3 * gas.specific_heat_J_per_kgK), gas.renewal)
                      .template grouped<G>();
  }

  /// On the momentum of face group q: share 4 mu h/R^2 sum y.
  [[gnu::always_inline]] WallAnswer<G> at_faces(int q, const G& u) const noexcept {
    return faces_[static_cast<std::size_t>(q)].answer(face_layer_, face_factor_, u);
  }
  [[gnu::always_inline]] void advance_faces(int q, const G& du) noexcept {
    faces_[static_cast<std::size_t>(q)].advance(face_layer_, du);
  }
  WallAnswer<S> at_end(End end, const S& u) const noexcept {
    return ends_[static_cast<std::size_t>(end)].answer(flow_layer_, flow_factor_, u);
  }
  void advance_end(End end, const S& du) noexcept { ends_[static_cast<std::size_t>(end)].advance(flow_layer_, du); }
  /// On the energy of cell group q: share 4 k h/R^2 sum y, the source in terms of R T.
  [[gnu::always_inline]] WallAnswer<G> in_cells(int q, const G& heat_diffusion, const G& T) const noexcept {
    WallAnswer<G> wall = cells_[static_cast<std::size_t>(q)].answer(cell_layer_, cell_factor_ * heat_diffusion, T);
    wall.source *= gas_constant_;
    return wall;
  }
  [[gnu::always_inline]] void advance_cells(int q, const G& dT) noexcept {
    cells_[static_cast<std::size_t>(q)].advance(cell_layer_, dT);
  }

 private:
  static constexpr unsigned steps_between_layers = 8;

  bool is_present_ = false;
  unsigned step_ = 0;
  S factor_{}, flow_factor_{};
  G face_factor_{}, cell_factor_{}, gas_constant_{};
  WallLayer<S> flow_layer_;
  WallLayer<G> face_layer_, cell_layer_;
  std::vector<WallMemory<G>> faces_, cells_;
  std::array<WallMemory<S>, 2> ends_;
};

}  // namespace pneuservo
