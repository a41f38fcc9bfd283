"""Every public member of the official client, called once against a live server; the outcome is docs/supported.json."""
