# A fresh Debian 12 root to try things in, from this machine's own mirror. Sourced after common.sh, not run.

# make_bare_root DIRECTORY KEEP: sets bare_root; removed at the end unless KEEP is 1. Exit 77 where it cannot be made.
make_bare_root() {
  bare_root=$1 bare_root_keep=$2
  ((EUID == 0)) || die 77 "SKIPPED: needs root"
  command -v debootstrap >/dev/null || die 77 "SKIPPED: debootstrap is not installed"
  local mirror
  mirror=$(apt-get indextargets --format '$(CODENAME) $(REPO_URI)' 2>/dev/null | sed -n 's/^bookworm //p' | head -n 1)
  [[ -n $mirror ]] || die 77 "SKIPPED: apt of this machine has no mirror of Debian 12"
  mkdir -p "$bare_root"
  bare_root=$(cd -- "$bare_root" && pwd)
  trap remove_bare_root EXIT
  say "Debian 12 from $mirror into $bare_root"
  quietly debootstrap debootstrap --variant=minbase bookworm "$bare_root" "$mirror" || die 1 "debootstrap failed"
  if ! mountpoint -q "$bare_root/proc"; then mount -t proc proc "$bare_root/proc"; fi
  cp --dereference /etc/resolv.conf "$bare_root/etc/resolv.conf"
  apt-config dump | grep -E '^Acquire::(https?::Proxy|Check-)' >"$bare_root/etc/apt/apt.conf.d/90machine" || true
}

remove_bare_root() {
  if mountpoint -q "$bare_root/proc"; then umount "$bare_root/proc" || return; fi
  if ((bare_root_keep == 0)); then rm -rf --one-file-system "$bare_root"; fi
}

# in_bare_root COMMAND...: runs it there, with nothing of this machine's environment.
in_bare_root() {
  chroot "$bare_root" env -i HOME=/root LC_ALL=C.UTF-8 PATH=/usr/sbin:/usr/bin:/sbin:/bin "$@" </dev/null
}
