"""The audit of the paper of Fulford, Maggiore and Apkarian, F."""
