"""CARLA 0.9.16's wire protocol without a socket: bytes in, typed values out, and back.

``rpc`` frames calls and answers, ``decode`` and ``encode`` go between msgpack's lists and named tuples, ``commands``
knows the batch, ``stream`` the sensor streams and their tokens, ``headers`` the packed structs before every payload,
``vocabulary`` every name the official client can call.
"""
