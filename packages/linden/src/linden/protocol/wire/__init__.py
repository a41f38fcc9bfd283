"""CARLA 0.9.16's wire protocol without a socket: bytes in, typed values out, and back.

``rpc`` frames calls and answers. ``decode`` goes from msgpack's lists to named tuples, ``answers`` the other way.
``commands`` knows the batch; ``controls`` and ``packed`` read long batches by column. ``stream`` has the sensor streams
and their tokens, ``measurements`` the packed structs of payloads, ``client_functions`` the names that the official
client can call.
"""
