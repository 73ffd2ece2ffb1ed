# Which processor each control process ticks on. Read by install.sh; wants its run, put, $units.
#
# A control process ticks on the last processor that it may use, the unnamed service's on the last
# of all: each line gets the highest that nobody has yet, never the first, which has the interrupts.
processors=$(nproc --all)
taken=
if [ -e "$units/multi-user.target.wants/aff-runtime.service" ]; then taken=$((processors - 1)); fi
for file in "$units"/aff-runtime@*.service.d/cpu.conf; do
    [ -f "$file" ] || continue
    last=$(sed -n 's/^CPUAffinity=\(.*[^0-9]\)\{0,1\}\([0-9]\{1,\}\) *$/\2/p' "$file")
    case " $taken " in
        *" $last "*)
            echo "install.sh: two control processes tick on processor $last: for a free one remove" \
                "$file and run this again" >&2 ;;
    esac
    taken="$taken $last"
done
# For the line whose drop-ins lie in $own.
give_processor() {
    last=$((processors - 1))
    while [ "$last" -gt 0 ]; do
        case " $taken " in *" $last "*) last=$((last - 1)) ;; *) break ;; esac
    done
    if [ "$last" -gt 0 ]; then
        put "$own/cpu.conf" "CPUAffinity=0-$last"
        taken="$taken $last"
    else
        echo "install.sh: no processor of its own is left for line $line, of $processors:" \
            "its ticks wait for those of another line" >&2
    fi
}
# What is not the control process of any line stays below the lowest of theirs.
below_control() {
    lowest=$((processors - 1))
    for last in $taken; do [ "$last" -ge "$lowest" ] || lowest=$last; done
    if [ "$lowest" -gt 0 ]; then
        put "$units/$1.service.d/cpu.conf" "CPUAffinity=0-$((lowest - 1))"
    else
        run rm -f "$units/$1.service.d/cpu.conf"
    fi
}
