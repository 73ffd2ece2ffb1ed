"""Bad site files: an edit of the shipped one, where it stands, and what must be said of it."""

CASES = {
    "wrong key": (
        ("settle_s: 6,", "setle_s: 6,"),
        "setle_s: 6,",
        "actuators.unwind.blocks[0].setle_s: unknown key. Did you mean settle_s?",
    ),
    "unknown key": (
        ("  cycle_ms: 5", "  zzz: 5"),
        "zzz",
        "line.zzz: unknown key. Known here: name, cycle_ms, speed, speed_reference, "
        "speed_max_m_s.",
    ),
    "reference that is no channel": (
        ("  cycle_ms: 5", "  cycle_ms: 5\n  speed_reference: line_sped_m_s"),
        "line_sped_m_s",
        "line.speed_reference: line_sped_m_s is no channel of gateway.read. Did you mean "
        "line_speed_m_s?",
    ),
    "reference in another unit": (
        ("  cycle_ms: 5", "  cycle_ms: 5\n  speed_reference: tension_ref_N"),
        "tension_ref_N",
        "line.speed_reference: tension_ref_N is in N. Name a channel in m/s.",
    ),
    "duplicate key": (
        ("  cycle_ms: 5", "  name: again"),
        "name: again",
        "line.name: key stands twice, first in line 15. Remove one of the two.",
    ),
    "bare exponent": (
        ("settle_s: 6,", "settle_s: 1e1,"),
        "1e1",
        'actuators.unwind.blocks[0].settle_s: "1e1" is text, not a number (YAML 1.1). Write 10.',
    ),
    "wrong unit": (
        ("    limit_m_s: 0.05", "    limit_m_s: 20 lbf"),
        "20 lbf",
        'actuators.unwind.limit_m_s: "20 lbf" is a force, expected a speed: a number in m/s, or '
        "with its unit (m/min, mm/s, cm/s).",
    ),
    "decimal comma": (
        ("    limit_m_s: 0.05", "    limit_m_s: 0,05"),
        "0,05",
        'actuators.unwind.limit_m_s: "0,05" has a decimal comma. Write 0.05.',
    ),
    "decimal comma in braces": (
        ("amp_limit_m_s: 0.02", "amp_limit_m_s: 0,02"),
        "0,02",
        'actuators.unwind.blocks[0].amp_limit_m_s: "0,02" has a decimal comma. Write 0.02.',
    ),
    "too large": (
        ("settle_s: 6,", "settle_s: 6 min,"),
        "6 min",
        "actuators.unwind.blocks[0].settle_s: 6 min (= 360 s) is too large. Allowed: 1 to 300 s.",
    ),
    "too large in the unit of the key": (
        ("    limit_m_s: 0.05", "    limit_m_s: 50 m/s"),
        "50 m/s",
        "actuators.unwind.limit_m_s: 50 m/s is too large. Allowed: above 0, up to 1 m/s.",
    ),
    "too large in another unit": (
        ("    limit_m_s: 0.05", "    limit_m_s: 120 m/min"),
        "120 m/min",
        "actuators.unwind.limit_m_s: 120 m/min (= 2 m/s) is too large. "
        "Allowed: above 0, up to 1 m/s.",
    ),
    "too small": (
        ("hold_after_ms: 15", "hold_after_ms: 1"),
        "1\n",
        "freshness.hold_after_ms: 1 ms is too small. Allowed: 2 to 200 ms.",
    ),
    "order out of bounds": (
        ("orders: [1, 2, 3, 4]", "orders: [1, 2, 65, 4]"),
        "65",
        "actuators.unwind.blocks[0].orders[2]: 65 is too large. Allowed: 1 to 64.",
    ),
    "not whole": (
        ("port: 5020", "port: 5020.0"),
        "5020.0",
        "gateway.modbus_tcp.port: 5020.0 is not a whole number. Write 5020.",
    ),
    "number as text": (
        ("port: 5020", 'port: "5020"'),
        '"5020"',
        "gateway.modbus_tcp.port: 5020 is not a whole number. Allowed: 1 to 65535.",
    ),
    "boolean as a whole number": (
        ("address_base: 0", "address_base: no"),
        "no\n",
        "gateway.address_base: no is not a whole number. Allowed: 0, 1.",
    ),
    "boolean as text": (
        ("name: Euclid", "name: off"),
        "off\n",
        'line.name: off is a boolean in YAML 1.1, not text. Write "off".',
    ),
    "number for text": (
        ("name: Euclid", "name: 7"),
        "7\n",
        'line.name: 7 is a number, not text. Write "7".',
    ),
    "text as boolean": (
        ("wraps: true", "wraps: sure"),
        "sure",
        "gateway.read.channels.unwind_angle_rad.wraps: sure is neither true nor false. "
        "Write true or false.",
    ),
    "wrong word": (
        ("word_order: high_first", "word_order: high_frist"),
        "high_frist",
        "gateway.word_order: high_frist is not known here. Did you mean high_first? Write one "
        "of: high_first, low_first.",
    ),
    "empty value": (
        ("  cycle_ms: 5", "  cycle_ms:"),
        "cycle_ms:\n",
        "line.cycle_ms: is empty. Write a value, or put # before the key to use its default.",
    ),
    "empty name": (
        ("name: Euclid", 'name: ""'),
        '""',
        "line.name: text of 0 characters. Write 1 to 200.",
    ),
    "value for a section": (
        ("plc_heartbeat: { register: 0 }", "plc_heartbeat: 0"),
        "0\n",
        'gateway.read.plc_heartbeat: "0" stands where a section is expected. Its keys: '
        "register, signal, type.",
    ),
    "value for a list": (
        ("orders: [1, 2, 3, 4]", "orders: 4"),
        "4",
        'actuators.unwind.blocks[0].orders: "4" stands where a list is expected. Write [4].',
    ),
    "empty list": (
        ("orders: [1, 2, 3, 4]", "orders: []"),
        "[]",
        "actuators.unwind.blocks[0].orders: needs 1 to 64 entries.",
    ),
    "bad scale": (
        ("scale: 0.02 mm", "scale: 0.02 mN"),
        "0.02 mN",
        'gateway.read.channels.unwind_radius_m.scale: "0.02 mN" is a force, expected a length',
    ),
    "zero scale": (
        ("type: u16, scale: 0.01 ", "type: u16, scale: 0 "),
        "0 ",
        "gateway.read.channels.tension_ref_N.scale: 0 would make every value 0.",
    ),
    "overlap": (
        ("tension_ref_N: { register: 4,", "tension_ref_N: { register: 3,"),
        "3,",
        "gateway.read.channels.tension_ref_N.register: wire address 3 is taken by "
        "gateway.read.channels.unwind_tension_N (i32, 2..3). Move one of the two.",
    ),
    "write on read": (
        ("state: { register: 101 }", "state: { register: 14 }"),
        "14 }",
        "gateway.write.state.register: wire address 14 is taken by "
        "gateway.read.channels.swrap_follower_angle_rad (i32, 13..14). Move one of the two.",
    ),
    "hole in the write block": (
        ("register: 108, complement: 109", "register: 109, complement: 110"),
        "109,",
        "gateway.write.corrections.swrap_follower.register: 1 word(s) between 107 and 109 would "
        "be written but are not ours. Move it to wire address 108.",
    ),
    "read block too long": (
        (
            "swrap_follower_angle_rad:\n        { register: 13",
            "swrap_follower_angle_rad:\n        { register: 200",
        ),
        "200",
        "gateway.read.channels.swrap_follower_angle_rad.register: the read block spans 202 words, "
        "125 fit one request.",
    ),
    "address above the wire": (
        ("roll_id: { register: 8 }", "roll_id: { register: 65536 }"),
        "65536",
        "gateway.read.roll_id.register: wire address 65536 does not exist (0..65535).",
    ),
    "the second word of a value above the wire": (
        ("unwind_tension_N: { register: 2,", "unwind_tension_N: { register: 65535,"),
        "65535",
        "gateway.read.channels.unwind_tension_N.register: wire address 65535..65536, the words of "
        "one value, does not exist (0..65535).",
    ),
    "unknown channel": (
        ("signal: unwind_tension_N,", "signal: unwind_tensoin_N,"),
        "unwind_tensoin_N,",
        "actuators.unwind.error.signal: unwind_tensoin_N is no channel of gateway.read. "
        "Did you mean unwind_tension_N?",
    ),
    "channel in another unit": (
        ("reference: tension_ref_N", "reference: line_speed_m_s"),
        "line_speed_m_s",
        "actuators.unwind.error.reference: line_speed_m_s is in m/s. Name a channel in N.",
    ),
    "supplier in a unit": (
        ("    resets_on: splice", "    resets_on: splice\n    supplier: tension_ref_N"),
        "tension_ref_N\n",
        "rolls.unwind.supplier: tension_ref_N is in N. Name a channel that ends with _number.",
    ),
    "supplier of a roller": (
        ("    #resets_on: never", "    supplier: line_speed_m_s"),
        "line_speed_m_s\n",
        "rolls.swrap_follower.supplier: only a roll that is exchanged on the run has a supplier.",
    ),
    "number with a scale": (
        (
            "      tension_ref_N:",
            "      lot_number: { register: 40, type: u16, scale: 10 }\n      tension_ref_N:",
        ),
        "10 }",
        "gateway.read.channels.lot_number.scale: a number is taken as the PLC has it. Write "
        "scale: 1.",
    ),
    "number with a scale in a unit": (
        (
            "      tension_ref_N:",
            "      lot_number: { register: 40, type: u16, scale: 1 N }\n      tension_ref_N:",
        ),
        "1 N }",
        "gateway.read.channels.lot_number.scale: a number has no unit. Write scale: 1.",
    ),
    "angle in another unit": (
        ("angle: unwind_angle_rad", "angle: unwind_radius_m"),
        "unwind_radius_m\n",
        "rolls.unwind.angle: unwind_radius_m is in m. Name a channel in rad.",
    ),
    "unknown roll": (
        ("{ roll: unwind, orders", "{ roll: unwnid, orders"),
        "unwnid",
        "actuators.unwind.blocks[0].roll: unwnid is no roll. Did you mean unwind?",
    ),
    "order twice": (
        ("orders: [1, 2, 3, 4]", "orders: [1, 2, 3, 2]"),
        "2]",
        "actuators.unwind.blocks[0].orders[3]: order 2 of unwind is already in blocks[0]",
    ),
    "fewer than five counts": (
        ("amp_limit_m_s: 0.02", "amp_limit_m_s: 0.00004"),
        "0.00004",
        "actuators.unwind.blocks[0].amp_limit_m_s: 0.00004 m/s is 4 counts of the correction word "
        "(0.00001). Need >= 5: a finer scale or a higher limit.",
    ),
    "limit above the word": (
        ("    limit_m_s: 0.05", "    limit_m_s: 0.33"),
        "0.33",
        "actuators.unwind.limit_m_s: 0.33 m/s is 33000 counts of 0.00001; the word holds 32767.",
    ),
    "block above its actuator": (
        ("amp_limit_m_s: 0.02", "amp_limit_m_s: 0.06"),
        "0.06",
        "actuators.unwind.blocks[0].amp_limit_m_s: 0.06 m/s is above the actuator's limit 0.05",
    ),
    "limit in the other unit": (
        ("    slew_m_s2: 2.0", "    slew_N_m_s: 2.0"),
        "slew_N_m_s",
        "actuators.unwind.slew_N_m_s: the actuator's output is in m/s. Write slew_m_s2.",
    ),
    "zero too late": (
        ("fade_ms: 150", "fade_ms: 221"),
        "221",
        "freshness.fade_ms: fault_after_ms + fade_ms is 301 ms; zero is due within 300 ms.",
    ),
    "hold after fault": (
        ("hold_after_ms: 15", "hold_after_ms: 80"),
        "80\n",
        "freshness.hold_after_ms: is not below fault_after_ms 80 ms.",
    ),
    "deadline beyond the cycle": (
        ("#deadline_ms: 3.0", "deadline_ms: 5 ms"),
        "5 ms",
        "gateway.modbus_tcp.deadline_ms: 5 ms is not below cycle_ms 5 ms",
    ),
    "range in another unit": (
        ("min_m_s: -1, max_m_s: 10", "min_N: -1, max_m_s: 10"),
        "min_N: -1",
        "plausibility.line_speed_m_s.min_N: the channel is in m/s. Write min_m_s.",
    ),
    "range upside down": (
        ("min_m_s: -1, max_m_s: 10", "min_m_s: 5, max_m_s: 4"),
        "4",
        "plausibility.line_speed_m_s.max_m_s: 4 is not above the minimum 5.",
    ),
    "channel without a unit": (
        ("swrap_follower_speed_m_s: {", "swrap_follower_speed: {"),
        "swrap_follower_speed: {",
        "gateway.read.channels.swrap_follower_speed: the name does not end with its SI unit.",
    ),
    "bad name": (
        ("  swrap_follower:\n    angle", "  S-wrap:\n    angle"),
        "S-wrap",
        "rolls.S-wrap: S-wrap is no name. Begin with a small letter",
    ),
    "radius range upside down": (
        ("radius_max_m: 12 in", "radius_max_m: 3 in"),
        "3 in",
        "rolls.unwind.radius_max_m: 0.0762 m is not above radius_min_m 0.1016 m.",
    ),
    "two radii": (
        ("    #resets_on: never", "    radius: unwind_radius_m"),
        None,
        "rolls.swrap_follower: needs one of radius (a channel) and radius_m (a fixed radius).",
    ),
    "one response for two": (
        ("learned/euclid_swrap_follower.json", "learned/euclid_unwind.json"),
        None,
        "actuators.swrap_follower.response: learned/euclid_unwind.json is the response of unwind.",
    ),
    "permissive that is none": (
        ("need: [LINE_RUN,", "need: [SPLICE_ACTIVE,"),
        "SPLICE_ACTIVE",
        "permissives.need[0]: SPLICE_ACTIVE is not known here.",
    ),
    "newer version": (
        ("version: 1\n", "version: 2\n"),
        "2\n",
        "version: 2 is not known here. Write one of: 1.",
    ),
}
