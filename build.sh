#!/usr/bin/env bash
# build.sh: the only door to luz: installs what is missing, builds, runs, tests, measures.
# Writes build/<variant>/build.ninja; see `./build.sh help`.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

# What a bare Debian 12 (or Ubuntu 23.04 and later) needs, by package name.
BUILD_PACKAGES="gcc g++ libc6-dev ninja-build git ca-certificates
    libvulkan-dev libvulkan-volk-dev libglfw3-dev libcglm-dev libglm-dev libtinygltf-dev
    libtomlplusplus-dev libstb-dev libimgui-dev libmeshoptimizer-dev libxxhash-dev libzstd-dev
    glslang-tools glslang-dev spirv-tools libcmocka-dev"
RUN_PACKAGES="libvulkan1 mesa-vulkan-drivers"
TEST_PACKAGES="vulkan-validationlayers xvfb xauth xdotool imagemagick x11-utils"

usage() {
    cat <<'EOF'
usage: ./build.sh [command] [--debug|--asan|--tsan|--cov] [args]

  (none), build    install what is missing, build everything
  run [args]       play the demo level; without a display: a camera tour as pictures in out/tour
  test [filter]    build and run all tests (names that contain filter); last line "N passed, N failed"
  bench [ids]      build and measure (see `./build.sh bench --help`)
  assets           build the generator and write data/models again
  packages         list the packages that are needed
  clean            remove build/
  help             this text

  --debug  -O0, poisoned memory, sanity checks     --asan  address + undefined sanitizers
  --tsan   thread sanitizer                        --cov   gcov counters
  Default is the release variant. Each variant lives in build/<variant>/.
  LUZ_NO_INSTALL=1 never calls apt-get. CC, CXX choose the compilers.
EOF
}

say() { printf '%s\n' "$*" >&2; }
die() { say "build.sh: $*"; exit 1; }

# --- packages ---

install_packages() { # names...
    local missing=() name
    if ! command -v dpkg-query >/dev/null 2>&1; then
        # Another system: the compiler's own messages would be riddles, so name what is needed.
        for name in ninja gcc g++ glslangValidator; do
            command -v "$name" >/dev/null 2>&1 || missing+=("$name")
        done
        [ ${#missing[@]} -eq 0 ] && return 0
        say "This is not a Debian or Ubuntu system. Please install what these Debian packages hold:"
        say "   " $BUILD_PACKAGES $RUN_PACKAGES $TEST_PACKAGES
        die "missing programs: ${missing[*]}"
    fi
    local installed
    installed=$(dpkg-query -W -f '${Package} ${db:Status-Status}\n' "$@" 2>/dev/null |
        sed -n 's/ installed$//p' || true)
    for name in "$@"; do
        grep -qx -- "$name" <<<"$installed" || missing+=("$name")
    done
    [ ${#missing[@]} -eq 0 ] && return 0
    [ "${LUZ_NO_INSTALL:-0}" = 1 ] && die "missing packages: ${missing[*]}"
    local sudo=""
    if [ "$(id -u)" != 0 ]; then
        command -v sudo >/dev/null 2>&1 ||
            die "please install as root: apt-get install ${missing[*]}"
        sudo=sudo
    fi
    say "installing ${#missing[@]} packages: ${missing[*]}"
    local apt=($sudo env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300 -qq)
    "${apt[@]}" update >&2 || say "package lists could not be refreshed; trying with the old ones"
    "${apt[@]}" install -y --no-install-recommends "${missing[@]}" >&2 ||
        die "apt-get could not install: ${missing[*]}"
}

# --- build.ninja ---

VARIANT=release
COMMAND=""
ARGS=()

configure() {
    local out=build/$VARIANT
    local cc=${CC:-gcc} cxx=${CXX:-g++} opt defines="" link="" launcher=""
    command -v ccache >/dev/null 2>&1 && launcher="ccache "
    case $VARIANT in
    release) opt="-O2 -g" ;;
    debug) opt="-O0 -g3"; defines="-DLUZ_POISON" ;;
    asan) opt="-O1 -g -fno-omit-frame-pointer -fsanitize=address,undefined -fno-sanitize-recover=undefined"
        defines="-DLUZ_POISON"; link="-fsanitize=address,undefined" ;;
    tsan) opt="-O1 -g -fsanitize=thread"; link="-fsanitize=thread" ;;
    cov) opt="-O0 -g --coverage"; link="--coverage" ;;
    esac
    # -ffp-contract=off: fused multiply-adds would give other bits on other machines.
    local warn="-Wall -Wextra -Wno-missing-field-initializers"
    local common="-D_GNU_SOURCE $opt $defines $warn -ffp-contract=off"

    # Regenerated only when the list of files or this script changes: a no-op build is one ninja call.
    local sources shaders stamp
    sources=$(find engine game tools tests \( -name '*.c' -o -name '*.cpp' \) -not -path '*/fuzz/*' 2>/dev/null | sort)
    shaders=$(find shaders \( -name '*.vert' -o -name '*.frag' -o -name '*.comp' \) | sort)
    stamp=$(printf '%s\n' "$sources" "$shaders" "$cc $cxx $launcher" | cat - build.sh | cksum)
    mkdir -p "$out/gen"
    local id
    id=$(git describe --always --dirty --abbrev=12 2>/dev/null || echo unknown)
    local id_text="const char *const luz_build_id = \"$id $VARIANT\";"
    [ "$(cat "$out/gen/build_id.c" 2>/dev/null)" = "$id_text" ] || printf '%s\n' "$id_text" >"$out/gen/build_id.c"
    if [ -f "$out/build.ninja" ] && [ "$(cat "$out/stamp" 2>/dev/null)" = "$stamp" ]; then return; fi

    local blobs=$out/gen/shader_blobs.c spv_list="" shader name symbol
    {
        echo '// Generated by build.sh: the compiled shaders as bytes.'
        echo '#include "../../../engine/gpu/shader_blobs.h"'
        for shader in $shaders; do
            name=${shader#shaders/} symbol=blob_$(tr -c 'a-zA-Z0-9\n' _ <<<"$name")
            echo "__asm__(\".section .rodata\\n.balign 16\\n$symbol:\\n.incbin \\\"$out/spv/$name.spv\\\"\\n${symbol}_end:\\n.previous\\n\");"
            echo "extern const uint32_t ${symbol}[], ${symbol}_end[];"
        done
        echo 'const ShaderBlob shader_blobs[] = {'
        for shader in $shaders; do
            name=${shader#shaders/} symbol=blob_$(tr -c 'a-zA-Z0-9\n' _ <<<"$name")
            echo "    {\"$name\", $symbol, ${symbol}_end},"
        done
        echo '};'
        echo "const uint32_t shader_blob_count = $(wc -w <<<"$shaders");"
    } >"$blobs.new"
    cmp -s "$blobs" "$blobs.new" && rm "$blobs.new" || mv "$blobs.new" "$blobs"

    {
        echo "ninja_required_version = 1.8"
        echo "builddir = $out"
        echo "rule cc"
        echo "  command = $launcher$cc -std=c17 $common \$flags -MMD -MF \$out.d -c \$in -o \$out"
        echo "  depfile = \$out.d"
        echo "  deps = gcc"
        echo "  description = cc \$in"
        echo "rule cxx"
        echo "  command = $launcher$cxx -std=c++17 $common \$flags -MMD -MF \$out.d -c \$in -o \$out"
        echo "  depfile = \$out.d"
        echo "  deps = gcc"
        echo "  description = c++ \$in"
        echo "rule ar"
        echo "  command = rm -f \$out && ar crs \$out \$in"
        echo "  description = ar \$out"
        echo "rule link"
        echo "  command = $cxx $link -o \$out \$in \$libs"
        echo "  description = link \$out"
        echo "rule spv"
        # The SPIR-V is not optimised: the drivers do that, and reflection wants the names. 1.2 is
        # the lowest Vulkan that the device layer accepts.
        echo "  command = glslangValidator --quiet -V --target-env vulkan1.2 -g -Ishaders --depfile \$out.d -o \$out \$in"
        echo "  depfile = \$out.d"
        echo "  deps = gcc"
        echo "  description = glsl \$in"

        for shader in $shaders; do
            echo "build $out/spv/${shader#shaders/}.spv: spv $shader"
            spv_list+=" $out/spv/${shader#shaders/}.spv"
        done
        local source object rule flags engine="" game="" tools="" tests="" assets=""
        for source in $sources; do
            object=$out/obj/$source.o rule=cc flags=""
            case $source in *.cpp) rule=cxx ;; esac
            case $source in
            */toml.cpp) flags="-DTOML_HEADER_ONLY=0 -DTOML_SHARED_LIB=1" ;;
            engine/app/debug_ui.cpp) flags="-I/usr/include/imgui" ;;
            engine/gpu/shader_compile.cpp) flags="-fno-sanitize=vptr" ;; # glslang has no RTTI
            esac
            case $source in
            engine/*) engine+=" $object" ;;
            game/*) game+=" $object"
                # Toolbox and tests know the game's components (game/project.c), not its main.
                [ "$source" = game/main.c ] || { tools+=" $object"; tests+=" $object"; } ;;
            tools/make_assets/*) assets+=" $object" ;;
            tools/*) tools+=" $object" ;;
            tests/*) tests+=" $object" ;;
            esac
            echo "build $object: $rule $source"
            [ -n "$flags" ] && echo "  flags = $flags"
        done
        echo "build $out/obj/shader_blobs.o: cc $blobs |$spv_list"
        echo "build $out/obj/build_id.o: cc $out/gen/build_id.c"
        echo "build $out/libluz.a: ar $engine $out/obj/shader_blobs.o $out/obj/build_id.o"
        local libs="$out/libluz.a -limgui -lglfw -ltinygltf -ltomlplusplus -lmeshoptimizer -lxxhash -lzstd -lstb"
        libs+=" -lglslang -lMachineIndependent -lGenericCodeGen -lOSDependent -lOGLCompiler"
        libs+=" -lglslang-default-resource-limits -lSPIRV -lSPIRV-Tools-opt -lSPIRV-Tools -lm -ldl -lpthread"
        local targets="$out/libluz.a"
        program() { # name objects extra-libs
            [ -n "$2" ] || return 0
            echo "build $out/$1: link $2 | $out/libluz.a"
            echo "  libs = $3 $libs"
            targets+=" $out/$1"
        }
        program luz "$tools" ""
        program luz_demo "$game" ""
        program luz_tests "$tests" "-lcmocka"
        if [ -n "$assets" ]; then
            echo "build $out/make_assets: link $assets"
            echo "  libs = -lm"
            targets+=" $out/make_assets"
        fi
        echo "default $targets"
    } >"$out/build.ninja"
    printf '%s' "$stamp" >"$out/stamp"
    ninja -f "$out/build.ninja" -t compdb cc cxx >compile_commands.json
}

build() {
    # Two builds of one variant at a time would write the same files.
    mkdir -p "build/$VARIANT"
    exec 9>"build/$VARIANT/lock"
    if command -v flock >/dev/null 2>&1; then flock 9; fi
    configure
    ninja -f "build/$VARIANT/build.ninja" --quiet >&2 || {
        # ccache or an interrupted run can leave nothing usable; the message above says what failed.
        die "the build failed"
    }
    exec 9>&-
}

# Sanitizer variants: the driver's own threads and leaks are not ours.
sanitizer_environment() {
    export ASAN_OPTIONS=${ASAN_OPTIONS:-detect_leaks=0:abort_on_error=0}
    export UBSAN_OPTIONS=${UBSAN_OPTIONS:-print_stacktrace=1}
    export TSAN_OPTIONS=${TSAN_OPTIONS:-ignore_noninstrumented_modules=1}
}

for arg in "$@"; do
    if [ -z "$COMMAND" ] || [ "$COMMAND" = build ]; then
        case $arg in
        --debug | --asan | --tsan | --cov) VARIANT=${arg#--}; continue ;;
        -h | --help) COMMAND=help; continue ;;
        esac
    fi
    if [ -z "$COMMAND" ]; then COMMAND=$arg; continue; fi
    case $COMMAND$arg in
    test--debug | test--asan | test--tsan | test--cov) VARIANT=${arg#test} VARIANT=${arg#--} ;;
    *) ARGS+=("$arg") ;;
    esac
done
COMMAND=${COMMAND:-build}

case $COMMAND in
help) usage ;;
packages) printf '%s\n' $BUILD_PACKAGES $RUN_PACKAGES $TEST_PACKAGES ;;
clean) rm -rf build compile_commands.json ;;
build)
    install_packages $BUILD_PACKAGES $RUN_PACKAGES
    build
    say "built build/$VARIANT: luz_demo (./build.sh run), luz (build/$VARIANT/luz --help)"
    ;;
run)
    install_packages $BUILD_PACKAGES $RUN_PACKAGES
    build
    exec "build/$VARIANT/luz_demo" ${ARGS[@]+"${ARGS[@]}"}
    ;;
bench)
    install_packages $BUILD_PACKAGES $RUN_PACKAGES
    build
    exec "build/$VARIANT/luz" bench ${ARGS[@]+"${ARGS[@]}"}
    ;;
assets)
    install_packages $BUILD_PACKAGES
    build
    exec "build/$VARIANT/make_assets" --out data/models ${ARGS[@]+"${ARGS[@]}"}
    ;;
test)
    install_packages $BUILD_PACKAGES $RUN_PACKAGES $TEST_PACKAGES
    build
    sanitizer_environment
    case $VARIANT in
    asan | tsan) exec "build/$VARIANT/luz_tests" --unit ${ARGS[@]+"${ARGS[@]}"} ;;
    *) exec "build/$VARIANT/luz_tests" ${ARGS[@]+"${ARGS[@]}"} ;;
    esac
    ;;
*)
    usage >&2
    die "unknown command '$COMMAND'"
    ;;
esac
