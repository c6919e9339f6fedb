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
  void set_share(const S& share) noexcept {
    is_present_ = any(share > S(0));
    factor_ = S(4) * share;
    cell_factor_ = replicate(factor_);
  }
  bool is_present() const noexcept { return is_present_; }
  void forget() noexcept {
    for_each_place([](WallMemory<G>& place) { place.forget(); });
    renew();
  }
  /// A change that was no number leaves no trace.
  void mend() noexcept {
    for_each_place([](WallMemory<G>& place) { place.mend(); });
  }
  /// The layers are wanted anew in the next step: its length is another.
  void renew() noexcept {
    step_ = 0;
    is_another_step_ = true;
  }
  /// Once a step: whether it wants its layers anew.
  bool begin_step() noexcept { return step_++ % steps_between_layers == 0; }
  /// Between renewals the layers change as slowly as the gas does, and what is held is taken as it is.
  void set_layers(const Gas& gas) noexcept {
    // Side by side where a group has room: a layer is a row of divisions.
    const S flow = gas.flow_diffusion / gas.density_kg_per_m3,
            heat = gas.heat_diffusion / (gas.density_kg_per_m3 * gas.specific_heat_J_per_kgK);
    G tau = replicate(flow);
    if constexpr (places_at_once > 1) set_element<S>(tau, 1, heat);
    const WallLayer<G> first(tau, replicate(gas.renewal));
    const WallLayer<G> face = first.template repeated<S>(0);
    const WallLayer<G> cell =
        places_at_once > 1 ? first.template repeated<S>(1) : WallLayer<G>(replicate(heat), replicate(gas.renewal));
    if (is_another_step_) {
      for (WallMemory<G>& place : faces_) place.change_layer(face_layer_, face);
      for (WallMemory<G>& place : cells_) place.change_layer(cell_layer_, cell);
      for (WallMemory<G>& end : ends_) end.change_layer(face_layer_, face);
    }
    is_another_step_ = false;
    face_layer_ = face;
    cell_layer_ = cell;
    flow_factor_ = factor_ * gas.flow_diffusion;
    flow_conductance_ = flow_factor_ * element<S>(face.answer, 0);
    face_factor_ = replicate(flow_factor_);
    face_conductance_ = replicate(flow_conductance_);
  }

  /// On the momentum of face group q: share 4 mu h/R^2 sum y.
  [[gnu::always_inline]] WallAnswer<G> at_faces(int q, const G& u) const noexcept {
    return wall_answer(face_conductance_, face_factor_, faces_[static_cast<std::size_t>(q)].kept(), u);
  }
  [[gnu::always_inline]] void advance_faces(int q, const G& du) noexcept {
    faces_[static_cast<std::size_t>(q)].advance(face_layer_, du);
  }
  [[gnu::always_inline]] WallAnswer<S> at_end(End end, const S& u) const noexcept {
    const auto i = static_cast<std::size_t>(end);
    const S kept = element<S>(ends_[i / places_at_once].kept(), static_cast<int>(i % places_at_once));
    return wall_answer(flow_conductance_, flow_factor_, kept, u);
  }
  [[gnu::always_inline]] void advance_ends(const S& du_port, const S& du_chamber) noexcept {
    if constexpr (places_at_once == 1) {
      ends_[0].advance(face_layer_, du_port);
      ends_[1].advance(face_layer_, du_chamber);
    } else {
      G du(0);
      set_element<S>(du, 0, du_port);
      set_element<S>(du, 1, du_chamber);
      ends_[0].advance(face_layer_, du);
    }
  }
  /// On the energy of cell group q: share 4 k h/R^2 sum y, with y of R T.
  [[gnu::always_inline]] WallAnswer<G> in_cells(int q, const G& heat_diffusion, const G& RT) const noexcept {
    const G factor = cell_factor_ * heat_diffusion;
    return wall_answer(factor * cell_layer_.answer, factor, cells_[static_cast<std::size_t>(q)].kept(), RT);
  }
  [[gnu::always_inline]] void advance_cells(int q, const G& dRT) noexcept {
    cells_[static_cast<std::size_t>(q)].advance(cell_layer_, dRT);
  }

 private:
  static constexpr unsigned steps_between_layers = 16;
  /// Both ends share a group that has several places, as do the two layers where they are made.
  static constexpr std::size_t places_at_once = GroupOf<S>::elements > 1 ? 2 : 1;

  template <class F> void for_each_place(F&& f) noexcept {
    for (WallMemory<G>& face : faces_) f(face);
    for (WallMemory<G>& cell : cells_) f(cell);
    for (WallMemory<G>& end : ends_) f(end);
  }

  bool is_present_ = false, is_another_step_ = true;
  unsigned step_ = 0;
  S factor_{}, flow_factor_{}, flow_conductance_{};
  G face_factor_{}, face_conductance_{}, cell_factor_{};
  WallLayer<G> face_layer_, cell_layer_;
  std::vector<WallMemory<G>> faces_, cells_;
  std::array<WallMemory<G>, 2 / places_at_once> ends_;
};

}  // namespace pneuservo
