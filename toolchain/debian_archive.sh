# SPDX-License-Identifier: Apache-2.0
# Sourced by scripts that take packages of any architecture from the Debian mirror this machine uses,
# without touching what is installed here.

# start_archive ARCHITECTURE FOLDER: apt's own state in FOLDER/apt, of a machine with nothing
# installed, so that packages come with all their dependencies.
start_archive() {
  archive_architecture=$1
  archive=$2/apt
  rm -rf "$archive"
  mkdir -p "$archive/lists/partial" "$archive/cache/archives/partial"
  : >"$archive/status"
  archive_apt -o APT::Update::Error-Mode=any update || {
    echo "some lists of the Debian mirror cannot be fetched: continuing with the others" >&2
    touch "$archive/unread"
  }
}

# fetch_packages PACKAGE...: into $archive/cache/archives. Skips with 77 if they cannot be
# downloaded; fails if the part of the archive that could be read lacks one.
fetch_packages() {
  archive_apt install --simulate "$@" >/dev/null || {
    [ -e "$archive/unread" ] || exit 1
    echo "skipped: the Debian mirror cannot be reached"
    exit 77
  }
  archive_apt install --download-only --yes "$@" >/dev/null ||
    { echo "skipped: the Debian mirror cannot be reached"; exit 77; }
}

# start_source_archive FOLDER: the same for the source packages of the Debian repositories that this
# machine uses. fetch_source SOURCE_PACKAGE TARGET unpacks the newest that the mirror has (some mirrors
# lack the sources of security updates), with Debian's patches, into TARGET.
start_source_archive() {
  apt-get indextargets --format 'deb-src $(SITE) $(RELEASE) $(COMPONENT)' \
    'Created-By: Packages' 'Origin: Debian' | sort -u >"$1/sources.list"
  archive_options=(-o Dir::Etc::SourceList="$1/sources.list" -o Dir::Etc::SourceParts=-)
  start_archive "$(dpkg --print-architecture)" "$1"
}
fetch_source() {
  local version
  for version in $(archive_run apt-cache showsrc --only-source "$1" | sed -n 's/^Version: //p' | sort -rVu); do
    if (cd "$archive" && archive_apt source --only-source --download-only "$1=$version" >/dev/null); then
      dpkg-source --no-check --extract "$archive/$1_${version#*:}.dsc" "$2" >/dev/null
      return
    fi
    echo "the Debian mirror does not give the source of $1 $version" >&2
  done
  echo "skipped: the Debian mirror cannot be reached, or lacks the source of $1"
  exit 77
}

archive_options=()
archive_apt() { archive_run apt-get "$@"; }
archive_run() {  # apt-get or apt-cache
  "$1" -qq -o Dir::State="$archive" -o Dir::State::status="$archive/status" \
    -o Dir::Cache="$archive/cache" -o APT::Architecture="$archive_architecture" \
    -o APT::Architectures="$archive_architecture" -o APT::Sandbox::User="$(id -un)" \
    -o Acquire::Languages=none -o Acquire::Retries=3 -o APT::Install-Recommends=false "${archive_options[@]}" "${@:2}"
}
